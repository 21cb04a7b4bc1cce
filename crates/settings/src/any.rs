//! Settings whose type is known to their owner alone.

use std::any::Any;
use std::fmt::Debug;

use crate::fields::Settings;

/// [`Settings`] with their type erased: what an experiment keeps of a problem or a learner.
pub trait AnySettings: Settings + Debug + Send + Sync {
    /// A copy.
    fn boxed(&self) -> Box<dyn AnySettings>;
    /// Whether others are of the same type and have the same values.
    fn equals(&self, other: &dyn AnySettings) -> bool;
    /// To get the type back.
    fn as_any(&self) -> &dyn Any;
    /// The same, to change them.
    fn as_any_mut(&mut self) -> &mut dyn Any;
}

impl<S: Settings + Clone + Debug + PartialEq + Send + Sync + 'static> AnySettings for S {
    fn boxed(&self) -> Box<dyn AnySettings> {
        Box::new(self.clone())
    }

    fn equals(&self, other: &dyn AnySettings) -> bool {
        other.as_any().downcast_ref::<S>() == Some(self)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }
}

impl Clone for Box<dyn AnySettings> {
    fn clone(&self) -> Self {
        (**self).boxed()
    }
}

impl PartialEq for Box<dyn AnySettings> {
    fn eq(&self, other: &Self) -> bool {
        (**self).equals(&**other)
    }
}
