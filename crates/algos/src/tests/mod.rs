//! What the tests of several learners share.

pub(crate) mod knob;
