//! Code of the caller's own, which a file can only name.

use std::fmt::Debug;
use std::sync::Arc;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// What is known by a name.
pub trait Named: Debug + Send + Sync {
    /// What it is, for messages: `class family`, say.
    const KIND: &'static str;
    /// How to put it in again: the name of a constructor.
    const CONSTRUCTOR: &'static str;

    /// Its name.
    fn name(&self) -> &str;
}

/// A caller's own code behind a shared pointer.
///
/// It is serialised as its name. Code cannot be read back from a name, so that deserialising it is an error
/// that says so: read the rest of the configuration and put the code in again. Two are equal if they are the
/// same object.
#[derive(Debug)]
pub struct ByName<T: ?Sized>(Arc<T>);

impl<T: ?Sized> ByName<T> {
    /// Wraps what is behind a pointer already.
    pub fn shared(code: Arc<T>) -> Self {
        Self(code)
    }

    /// What is behind the pointer.
    pub fn get(&self) -> &T {
        &self.0
    }
}

impl<T: ?Sized> Clone for ByName<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T: ?Sized> PartialEq for ByName<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl<T: Named + ?Sized> Serialize for ByName<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<'de, T: Named + ?Sized> Deserialize<'de> for ByName<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let (kind, constructor) = (T::KIND, T::CONSTRUCTOR);
        Err(D::Error::custom(format!(
            "the {kind} \"{name}\" is code, which no file holds: take its term out of the file, read \
             the rest, and add the term again with {constructor}"
        )))
    }
}
