//! Closed sets of names, written once for reading, writing and messages.

/// One of some names; made by [`choice!`](crate::choice!).
pub trait Choice: Copy + PartialEq + 'static {
    /// Every one, with its name in files.
    const ALL: &'static [(&'static str, Self)];

    /// Its name in files.
    fn name(self) -> &'static str;

    /// The one of this name.
    fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(other, _)| *other == name).map(|&(_, value)| value)
    }
}

/// An enum whose variants have names in files.
///
/// ```
/// hwasp_settings::choice! {
///     /// From where one looks.
///     pub enum Viewpoint {
///         /// From the world.
///         World = "world",
///         /// From the palm.
///         Palm = "palm",
///     }
/// }
/// assert_eq!(Viewpoint::from_name("palm").map(Viewpoint::name), Some("palm"));
/// ```
#[macro_export]
macro_rules! choice {
    ($(#[$meta:meta])* $vis:vis enum $enum:ident { $($(#[$doc:meta])* $variant:ident = $name:literal),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        $vis enum $enum {
            $($(#[$doc])* $variant),+
        }

        impl $enum {
            /// Every one, with its name in files.
            pub const ALL: &'static [(&'static str, Self)] = &[$(($name, Self::$variant)),+];

            /// Its name in files.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            /// The one of this name.
            pub fn from_name(name: &str) -> Option<Self> {
                <Self as $crate::Choice>::from_name(name)
            }
        }

        impl $crate::Choice for $enum {
            const ALL: &'static [(&'static str, Self)] = Self::ALL;

            fn name(self) -> &'static str {
                self.name()
            }
        }

        impl ::std::fmt::Display for $enum {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}
