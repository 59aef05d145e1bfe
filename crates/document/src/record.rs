//! Results as data, each stated once: what a field means, its type and where its value comes from stand together.
//!
//! ```text
//! records! {
//!     /// A mode of the arm.
//!     pub struct ModeFigures from mode: &Mode {
//!         /// Natural frequency.
//!         frequency_hz: FrequencyHz = mode.natural_frequency().into(),
//!     }
//! }
//! ```
//!
//! declares a struct that serialises and has a schema, and makes it from a `&Mode` by `From`. With
//! `of (mode: &Mode, number: usize)` in place of `from mode: &Mode` it is made by `ModeFigures::of(mode, number)`. What
//! several fields share is computed by statements before them: `{ let .. } with { fields }`. A field `name?: T` is an
//! `Option<T>` that is left out where there is none.

/// Declares results, as the head of this module says.
#[macro_export]
macro_rules! records {
    () => {};
    // From one thing, which needs no parentheses.
    ($(#[$about:meta])* $seen:vis struct $name:ident from $source:ident: $given:ty { $($body:tt)* } $($rest:tt)*) => {
        $crate::records! { $(#[$about])* $seen struct $name from ($source: $given) { $($body)* } $($rest)* }
    };
    ($(#[$about:meta])* $seen:vis struct $name:ident $by:ident $given:tt $shared:tt with $fields:tt $($rest:tt)*) => {
        $crate::records! { @fields { $(#[$about])* $seen struct $name $by $given $shared } {} $fields }
        $crate::records! { $($rest)* }
    };
    // Without what fields share.
    ($(#[$about:meta])* $seen:vis struct $name:ident $by:ident $given:tt $fields:tt $($rest:tt)*) => {
        $crate::records! { $(#[$about])* $seen struct $name $by $given {} with $fields $($rest)* }
    };
    // Field by field: those that are done, and those to do.
    (@fields $of:tt {$($done:tt)*}
        {$(#[$meaning:meta])* $shown:vis $field:ident?: $type:ty = $value:expr $(, $($rest:tt)*)?}) => {
        $crate::records! { @fields $of {
            $($done)* $(#[$meaning])* #[serde(skip_serializing_if = "Option::is_none")]
            $shown $field: Option<$type> = $value,
        } {$($($rest)*)?} }
    };
    (@fields $of:tt {$($done:tt)*}
        {$(#[$meaning:meta])* $shown:vis $field:ident: $type:ty = $value:expr $(, $($rest:tt)*)?}) => {
        $crate::records! { @fields $of {
            $($done)* $(#[$meaning])* $shown $field: $type = $value,
        } {$($($rest)*)?} }
    };
    (@fields { $(#[$about:meta])* $seen:vis struct $name:ident $by:ident $given:tt {$($shared:tt)*} }
        {$($(#[$meaning:meta])* $shown:vis $field:ident: $type:ty = $value:expr,)*} {}) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
        $seen struct $name { $($(#[$meaning])* $shown $field: $type),* }

        $crate::records! { @$by $name $given { $($shared)* Self { $($field: $value),* } } }
    };
    (@from $name:ident ($source:ident: $given:ty) $body:block) => {
        impl From<$given> for $name {
            fn from($source: $given) -> Self $body
        }
    };
    (@of $name:ident ($($source:ident: $given:ty),* $(,)?) $body:block) => {
        impl $name {
            /// It, as its fields say.
            pub(crate) fn of($($source: $given),*) -> Self $body
        }
    };
}

#[cfg(test)]
mod tests {
    use crate::figure::PlaceMm;
    use serde_json::json;
    use serde_json::to_value;

    records! {
        /// From one thing.
        struct Length from length: f64 {
            /// In mm.
            length_mm: PlaceMm = length.into(),
        }

        /// From two, with what its fields share.
        #[derive(Default)]
        struct Ends of (middle: f64, half: f64) {
            let [from, to] = [middle - half, middle + half];
        } with {
            /// The first.
            from_mm: PlaceMm = from.into(),
            /// The last.
            to_mm?: PlaceMm = (to > from).then(|| to.into()),
        }
    }

    #[test]
    fn records_are_made_of_what_their_fields_say() {
        assert_eq!(to_value(Length::from(0.5)).unwrap(), json!({ "length_mm": 500.0 }));
        assert_eq!(to_value(Ends::of(1.0, 0.25)).unwrap(), json!({ "from_mm": 750.0, "to_mm": 1250.0 }));
        assert_eq!(to_value(Ends::of(1.0, 0.0)).unwrap(), json!({ "from_mm": 1000.0 }));
        assert_eq!(Ends::default().from_mm, PlaceMm(0.0));
    }
}
