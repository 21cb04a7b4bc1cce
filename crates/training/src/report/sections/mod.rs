//! The chapters of a run's report, one file each.

pub(super) mod curves;
pub(super) mod design;
pub(super) mod hand;
pub(super) mod law;
pub(super) mod outcome;
pub(super) mod overview;
pub(super) mod parts;
pub(super) mod provenance;
pub(super) mod tolerances;
