//! Something for each action.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeTuple, Serializer};

use crate::signal::MAX_ACTIONS;

/// An array of something for each action that there can be, which has a default value and goes
/// into files as other arrays do; those of more than 32 do neither.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByAction<T>(pub [T; MAX_ACTIONS]);

impl<T: Default> Default for ByAction<T> {
    fn default() -> Self {
        Self(std::array::from_fn(|_| T::default()))
    }
}

impl<T> Deref for ByAction<T> {
    type Target = [T; MAX_ACTIONS];

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<T> DerefMut for ByAction<T> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl<T: Serialize> Serialize for ByAction<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(MAX_ACTIONS)?;
        self.iter()
            .try_for_each(|one| tuple.serialize_element(one))?;
        tuple.end()
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for ByAction<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(MAX_ACTIONS, Reader(PhantomData))
    }
}

struct Reader<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Reader<T> {
    type Value = ByAction<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an array of length {MAX_ACTIONS}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<Self::Value, A::Error> {
        let mut all = Vec::with_capacity(MAX_ACTIONS);
        while all.len() < MAX_ACTIONS
            && let Some(one) = parts.next_element()?
        {
            all.push(one);
        }
        let found = all.len();
        let all = all.try_into().map(ByAction);
        all.map_err(|_| A::Error::invalid_length(found, &self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Held = ByAction<u8>;

    #[test]
    fn a_file_has_one_entry_for_each_action_and_nothing_beside_them() {
        let all: Vec<u8> = (0..MAX_ACTIONS).map(|at| at as u8).collect();
        let held = ByAction(all.clone().try_into().unwrap());
        let bytes = postcard::to_allocvec(&held).unwrap();
        assert_eq!(bytes, all);
        assert_eq!(postcard::from_bytes::<Held>(&bytes).unwrap(), held);
        let text = serde_json::to_string(&held).unwrap();
        assert_eq!(text, serde_json::to_string(&all).unwrap());
        assert_eq!(serde_json::from_str::<Held>(&text).unwrap(), held);
    }

    #[test]
    fn an_entry_too_few_or_too_many_is_refused() {
        let accepted = |count| {
            let text = serde_json::to_string(&vec![0; count]).unwrap();
            serde_json::from_str::<Held>(&text)
        };
        assert!(accepted(MAX_ACTIONS).is_ok());
        let error = accepted(MAX_ACTIONS - 1).unwrap_err().to_string();
        let expected = format!("expected an array of length {MAX_ACTIONS}");
        assert!(error.contains(&expected), "{error}");
        assert!(accepted(MAX_ACTIONS + 1).is_err());
    }
}
