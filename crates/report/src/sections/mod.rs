//! The chapters of a run's report, one file each.

pub(crate) mod curves;
pub(crate) mod design;
pub(crate) mod files;
pub(crate) mod hand;
pub(crate) mod law;
pub(crate) mod outcome;
pub(crate) mod overview;
pub(crate) mod parts;
pub(crate) mod provenance;
pub(crate) mod tolerances;
pub(crate) mod verdict;
