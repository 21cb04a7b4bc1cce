//! Types of the values that RTDE carries.

/// A type, as RTDE names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "they are named after what they hold")]
pub enum FieldType {
    Bool,
    Uint8,
    Uint32,
    Uint64,
    Int32,
    Double,
    Vector3,
    Vector6,
    Vector6Int32,
    Vector6Uint32,
}

/// Every type with its name and its size in bytes.
const ALL: [(FieldType, &str, usize); 10] = [
    (FieldType::Bool, "BOOL", 1),
    (FieldType::Uint8, "UINT8", 1),
    (FieldType::Uint32, "UINT32", 4),
    (FieldType::Uint64, "UINT64", 8),
    (FieldType::Int32, "INT32", 4),
    (FieldType::Double, "DOUBLE", 8),
    (FieldType::Vector3, "VECTOR3D", 24),
    (FieldType::Vector6, "VECTOR6D", 48),
    (FieldType::Vector6Int32, "VECTOR6INT32", 24),
    (FieldType::Vector6Uint32, "VECTOR6UINT32", 24),
];

impl FieldType {
    /// Its name on the line.
    pub fn name(self) -> &'static str {
        ALL[self as usize].1
    }

    /// Bytes of a value.
    pub fn size(self) -> usize {
        ALL[self as usize].2
    }

    /// The type of this name.
    pub fn named(name: &str) -> Option<Self> {
        ALL.iter().find(|entry| entry.1 == name).map(|entry| entry.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_type_stands_at_its_own_place() {
        for (index, entry) in ALL.iter().enumerate() {
            assert_eq!(entry.0 as usize, index);
            assert_eq!(FieldType::named(entry.0.name()), Some(entry.0));
        }
        assert_eq!(FieldType::named("NOT_FOUND"), None);
    }
}
