//! From a path to the element of the engine's specification.

use std::ptr;

use hwasp_settings::nearest;
use mujoco_rs::mujoco_c::{mjs_getCompiler, mjs_getParent, mjsElement};
use mujoco_rs::prelude::{MjOption, MjSpec, SpecElement, SpecObject};
use mujoco_rs::wrappers::mj_editing::{
    MjsActuator, MjsBody, MjsCompiler, MjsEquality, MjsGeom, MjsJoint, MjsSite, MjsTendon,
};

use super::super::Kind;
use super::numbers::Numbers;
use super::{Element, FieldPath, Spec, SpecError};

/// An element of a specification.
#[derive(Clone, Copy)]
pub(super) enum Item<'a> {
    Body(&'a MjsBody),
    Geom(&'a MjsGeom),
    Joint(&'a MjsJoint),
    Site(&'a MjsSite),
    Actuator(&'a MjsActuator),
    Tendon(&'a MjsTendon),
    Equality(&'a MjsEquality),
    Options(&'a MjOption),
}

impl Item<'_> {
    /// One number, as the text has it.
    pub(super) fn number(self, field: &str, index: usize) -> f64 {
        match self {
            Self::Body(item) => item.number(field, index),
            Self::Geom(item) => item.number(field, index),
            Self::Joint(item) => item.number(field, index),
            Self::Site(item) => item.number(field, index),
            Self::Actuator(item) => item.number(field, index),
            Self::Tendon(item) => item.number(field, index),
            Self::Equality(item) => item.number(field, index),
            Self::Options(item) => item.number(field, index),
        }
    }

    /// The compiler settings of the file that the element comes from.
    #[expect(unsafe_code, reason = "the wrapper has only the settings of the whole specification")]
    pub(super) fn compiler(&self) -> Option<&MjsCompiler> {
        let element = match self {
            Self::Body(item) => item.element_pointer(),
            Self::Geom(item) => item.element_pointer(),
            Self::Joint(item) => item.element_pointer(),
            Self::Site(item) => item.element_pointer(),
            Self::Actuator(item) => item.element_pointer(),
            Self::Tendon(item) => item.element_pointer(),
            Self::Equality(item) => item.element_pointer(),
            Self::Options(_) => return None,
        };
        // SAFETY: the element belongs to a live specification, and so do the settings. The wrapper's type has no data of its
        // own: it stands at the address of the engine's, which is how the wrapper makes it too.
        unsafe { mjs_getCompiler(element).cast_const().cast::<MjsCompiler>().as_ref() }
    }
}

impl Spec {
    /// The element that a path names, and its place among those of its kind.
    pub(super) fn find(&self, path: &FieldPath) -> Result<(usize, Item<'_>), SpecError> {
        let place = self.place(path.kind(), path.element())?;
        let item = self.item(path.kind(), place).ok_or_else(|| self.unknown(path.kind(), path.element()))?;
        Ok((place, item))
    }

    /// The names of the elements of a kind, in their order; empty where an element has none. Actuators without a name have
    /// the name of what they drive.
    pub fn names(&self, kind: Kind) -> Vec<String> {
        fn all<'a, T: SpecElement + 'a>(items: impl Iterator<Item = &'a T>) -> Vec<String> {
            items.map(|item| item.name().to_owned()).collect()
        }
        match kind {
            Kind::Body => all(self.inner.body_iter()),
            Kind::Geom => all(self.inner.geom_iter()),
            Kind::Joint => all(self.inner.joint_iter()),
            Kind::Site => all(self.inner.site_iter()),
            Kind::Tendon => all(self.inner.tendon_iter()),
            Kind::Equality => all(self.inner.equality_iter()),
            Kind::Camera => all(self.inner.camera_iter()),
            Kind::Sensor => all(self.inner.sensor_iter()),
            Kind::Keyframe => all(self.inner.key_iter()),
            Kind::Actuator => {
                let named = |actuator: &MjsActuator| match actuator.name() {
                    "" => actuator.target().to_owned(),
                    name => name.to_owned(),
                };
                self.inner.actuator_iter().map(named).collect()
            }
            Kind::Options => Vec::new(),
        }
    }

    /// The place of an element among those of its kind. An index may be too large.
    pub(super) fn place(&self, kind: Kind, element: &Element) -> Result<usize, SpecError> {
        let found = match element {
            Element::Only => Some(0),
            Element::Index(index) => Some(*index),
            Element::Name(name) => match kind {
                Kind::Body => position(self.inner.body_iter(), name),
                Kind::Geom => position(self.inner.geom_iter(), name),
                Kind::Joint => position(self.inner.joint_iter(), name),
                Kind::Site => position(self.inner.site_iter(), name),
                Kind::Tendon => position(self.inner.tendon_iter(), name),
                Kind::Equality => position(self.inner.equality_iter(), name),
                Kind::Actuator => match position(self.inner.actuator_iter(), name) {
                    Some(place) => Some(place),
                    None => self.driving(name)?,
                },
                Kind::Camera | Kind::Sensor | Kind::Keyframe | Kind::Options => None,
            },
        };
        found.ok_or_else(|| self.unknown(kind, element))
    }

    /// The only actuator without a name that drives something of this name.
    fn driving(&self, name: &str) -> Result<Option<usize>, SpecError> {
        let drives = |actuator: &MjsActuator| actuator.name().is_empty() && actuator.target() == name;
        let mut places =
            self.inner.actuator_iter().enumerate().filter(|(_, actuator)| drives(actuator)).map(|(place, _)| place);
        match (places.next(), places.count()) {
            (first, 0) => Ok(first),
            (first, others) => Err(SpecError::Ambiguous {
                given: name.to_owned(),
                count: others + 1,
                first: first.unwrap_or_default(),
            }),
        }
    }

    /// The element of a kind at a place, if there are so many.
    pub(super) fn item(&self, kind: Kind, place: usize) -> Option<Item<'_>> {
        self.items(kind).into_iter().nth(place)
    }

    /// The elements of a kind whose fields can be set. The engine walks the whole tree for one as for all.
    pub(super) fn items(&self, kind: Kind) -> Vec<Item<'_>> {
        let spec = &self.inner;
        match kind {
            Kind::Body => spec.body_iter().map(Item::Body).collect(),
            Kind::Geom => spec.geom_iter().map(Item::Geom).collect(),
            Kind::Joint => spec.joint_iter().map(Item::Joint).collect(),
            Kind::Site => spec.site_iter().map(Item::Site).collect(),
            Kind::Actuator => spec.actuator_iter().map(Item::Actuator).collect(),
            Kind::Tendon => spec.tendon_iter().map(Item::Tendon).collect(),
            Kind::Equality => spec.equality_iter().map(Item::Equality).collect(),
            Kind::Options => vec![Item::Options(spec.option())],
            Kind::Camera | Kind::Sensor | Kind::Keyframe => Vec::new(),
        }
    }

    /// Writes one number of an element that [`Self::find`] found, as the text has it.
    pub(super) fn write(&mut self, kind: Kind, place: usize, field: &str, index: usize, value: f64) {
        fn into<'a, T: Numbers + 'a>(items: &mut dyn Iterator<Item = &'a mut T>, place: usize, write: impl Fn(&mut T)) {
            write(items.nth(place).expect("the place was found a moment ago"));
        }
        macro_rules! write {
            ($items:ident) => {
                into(&mut self.inner.$items(), place, |item| item.set_number(field, index, value))
            };
        }
        match kind {
            Kind::Body => body_mut(&mut self.inner, place)
                .expect("the place was found a moment ago")
                .set_number(field, index, value),
            Kind::Geom => write!(geom_iter_mut),
            Kind::Joint => write!(joint_iter_mut),
            Kind::Site => write!(site_iter_mut),
            Kind::Actuator => write!(actuator_iter_mut),
            Kind::Tendon => write!(tendon_iter_mut),
            Kind::Equality => write!(equality_iter_mut),
            Kind::Options => self.inner.option_mut().set_number(field, index, value),
            Kind::Camera | Kind::Sensor | Kind::Keyframe => unreachable!("such elements have no fields"),
        }
    }

    fn unknown(&self, kind: Kind, element: &Element) -> SpecError {
        let names = self.names(kind);
        let count = names.len();
        let names: Vec<String> = names.into_iter().filter(|name| !name.is_empty()).collect();
        let given = match element {
            Element::Name(name) => name.clone(),
            other => other.to_string(),
        };
        let nearest = match element {
            Element::Name(name) => nearest(name, names.iter().map(String::as_str)).map(str::to_owned),
            _ => None,
        };
        SpecError::UnknownElement { kind, given, nearest, names, count }
    }
}

fn position<'a, T: SpecElement + 'a>(mut items: impl Iterator<Item = &'a T>, name: &str) -> Option<usize> {
    items.position(|item| item.name() == name)
}

/// A body by its place. The wrapper finds bodies by name or walks the tree.
#[expect(unsafe_code, reason = "bodies may have no name")]
pub(super) fn body_mut(spec: &mut MjSpec, place: usize) -> Option<&mut MjsBody> {
    let element: *mut mjsElement = spec.body_iter().nth(place)?.element_pointer().cast_mut();
    // SAFETY: the element is a live body of the specification, and while the specification is borrowed mutably nobody has
    // another handle of it.
    unsafe { MjsBody::from_element_as_ptr_mut(element).as_mut() }
}

/// The body that an element belongs to, and its place among the bodies.
#[expect(unsafe_code, reason = "the wrapper does not say where an element belongs")]
pub(super) fn parent<'a>(spec: &'a MjSpec, item: &impl SpecElement) -> Option<(usize, &'a MjsBody)> {
    // SAFETY: the element belongs to a live specification; the pointer is compared and not read.
    let parent = unsafe { mjs_getParent(item.element_pointer()) }.cast_const();
    spec.body_iter().enumerate().find(|(_, body)| ptr::eq(body.ffi(), parent))
}
