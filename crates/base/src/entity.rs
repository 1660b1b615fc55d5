//! Typed ids, and the map that owns the entities of the ids. A value refers to another by id, never by reference, so
//! that stage values stay plain data.

use serde::{Deserialize, Serialize};
use std::marker::PhantomData;

/// An index into a [`PrimaryMap`].
pub trait EntityId: Copy {
    /// The id of the entity at `index`.
    fn new(index: usize) -> Self;
    /// Position of the entity in its map.
    fn index(self) -> usize;
}

/// Declares an id type whose text form is the prefix and the index (`tool0`).
#[macro_export]
macro_rules! entity_id {
    ($(#[$doc:meta])* $name:ident, $prefix:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
        #[serde(transparent)]
        pub struct $name(u32);

        impl $crate::entity::EntityId for $name {
            fn new(index: usize) -> Self {
                Self(u32::try_from(index).unwrap_or(u32::MAX))
            }
            fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, concat!($prefix, "{}"), self.0)
            }
        }
    };
}

/// Owns the entities of one kind, in the order in which they were made; as data, a list of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PrimaryMap<K, V> {
    values: Vec<V>,
    #[serde(skip)]
    key: PhantomData<K>,
}

impl<K: EntityId, V> PrimaryMap<K, V> {
    /// An empty map.
    pub fn new() -> Self {
        Self { values: Vec::new(), key: PhantomData }
    }

    /// Adds an entity and returns its id.
    pub fn push(&mut self, value: V) -> K {
        self.values.push(value);
        K::new(self.values.len() - 1)
    }

    /// Number of entities.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// True when there is no entity.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Ids and entities in order.
    pub fn iter(&self) -> impl Iterator<Item = (K, &V)> {
        self.values.iter().enumerate().map(|(i, v)| (K::new(i), v))
    }

    /// Ids in order.
    pub fn ids(&self) -> impl Iterator<Item = K> + use<K, V> {
        (0..self.values.len()).map(K::new)
    }
}

impl<K: EntityId, V> Default for PrimaryMap<K, V> {
    fn default() -> Self {
        Self::new()
    }
}

/// Ids come only from the map that they index, or were checked when they were read, so an index is always in range.
impl<K: EntityId, V> std::ops::Index<K> for PrimaryMap<K, V> {
    type Output = V;
    fn index(&self, id: K) -> &V {
        &self.values[id.index()]
    }
}
