//! What all results have in common: files, one JSON document, and a text.

use crate::Error;
use serde_json::Value;
use std::path::PathBuf;
use stead_numerics::message::{Note, Warning};
use stead_report::{Files, Folder};

/// A result as files, as a document and as a text; [`result!`] makes the public methods of it.
pub(crate) trait Report {
    /// Writes the files that the command of the same name leaves, if it leaves any.
    fn write_files(&self, _: &Folder) -> Result<Vec<PathBuf>, Error> {
        Ok(Vec::new())
    }
    /// The same files in memory.
    fn files(&self) -> Result<Files, Error> {
        Ok(Files::new())
    }
    /// What the command prints with `--json`.
    fn document(&self) -> Value;
    /// What the command prints.
    fn table(&self) -> String;
    /// What the result rests on.
    fn notes(&self) -> &[Note] {
        &[]
    }
    /// Why the result may not be what was wanted.
    fn warnings(&self) -> &[Warning] {
        &[]
    }
}

/// A method of a [`Report`] by its body.
macro_rules! method {
    (write $self:ident ($folder:ident) $body:expr) => {
        fn write_files(&$self, $folder: &stead_report::Folder) -> Result<Vec<std::path::PathBuf>, crate::Error> {
            Ok($body?)
        }
    };
    (files $self:ident $body:expr) => {
        fn files(&$self) -> Result<stead_report::Files, crate::Error> {
            Ok($body?)
        }
    };
    (document $self:ident $body:expr) => {
        fn document(&$self) -> serde_json::Value {
            $body
        }
    };
    (table $self:ident $body:expr) => {
        fn table(&$self) -> String {
            $body
        }
    };
    (notes $self:ident $body:expr) => {
        fn notes(&$self) -> &[crate::monitor::Note] {
            &$body
        }
    };
    (warnings $self:ident $body:expr) => {
        fn warnings(&$self) -> &[crate::monitor::Warning] {
            &$body
        }
    };
}
pub(crate) use method;

/// The public face of a [`Report`], and the report itself where its methods are given.
macro_rules! result {
    ($name:ident, $self:ident { $($method:ident $(($folder:ident))? = $body:expr;)+ }) => {
        impl crate::result::Report for $name {
            $(crate::result::method!($method $self $(($folder))? $body);)+
        }

        crate::result::result!($name);
    };
    ($name:ident) => {
        impl $name {
            /// Writes the files that the command of the same name leaves, byte for byte, into a folder that is made
            /// where it is missing, and `manifest.json` with their digests. Returns the paths of the files.
            ///
            /// # Errors
            /// [`Error::Output`](crate::Error::Output): the folder or a file cannot be written, or another run writes
            /// to it; no file is left half written.
            pub fn write(
                &self,
                folder: impl AsRef<std::path::Path>,
            ) -> Result<Vec<std::path::PathBuf>, crate::Error> {
                self.write_in(&stead_report::Folder::create(folder.as_ref())?)
            }

            /// As [`write`](Self::write), into a folder that this process holds already: taken before a long job, no
            /// other run can take it in the meantime.
            ///
            /// # Errors
            /// As [`write`](Self::write).
            pub fn write_in(&self, folder: &stead_report::Folder) -> Result<Vec<std::path::PathBuf>, crate::Error> {
                crate::result::Report::write_files(self, folder)
            }

            /// The names and contents of the files that [`write`](Self::write) leaves, without `manifest.json`: tables
            /// as CSV, pictures as SVG.
            ///
            /// # Errors
            /// [`Error::Output`](crate::Error::Output): a file cannot be made.
            pub fn to_files(&self) -> Result<Vec<(String, Vec<u8>)>, crate::Error> {
                crate::result::Report::files(self)
            }

            /// What the user should know about the input though it is not wrong, in sentences: assumptions, and values
            /// left at their defaults.
            pub fn notes(&self) -> &[crate::monitor::Note] {
                crate::result::Report::notes(self)
            }

            /// Why the result may not be what was wanted.
            pub fn warnings(&self) -> &[crate::monitor::Warning] {
                crate::result::Report::warnings(self)
            }
        }

        crate::result::printed! { $name, self {
            document = crate::result::Report::document(self);
            table = crate::result::Report::table(self);
        } }
    };
}
pub(crate) use result;

/// What a command prints of a result: its JSON document, and its text.
macro_rules! printed {
    ($name:ident, $self:ident { document = $document:expr; table = $table:expr; }) => {
        impl $name {
            /// The JSON document that the command prints with `--json`. Units are in the names of the fields.
            pub fn to_json(&$self) -> serde_json::Value {
                $document
            }
        }

        impl serde::Serialize for $name {
            /// As [`to_json`](Self::to_json).
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                self.to_json().serialize(serializer)
            }
        }

        impl std::fmt::Display for $name {
            /// The text that the command prints.
            fn fmt(&$self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(&$table)
            }
        }
    };
}
pub(crate) use printed;
