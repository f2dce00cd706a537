//! Generational ids: an id stays unique after its rule was deleted.

use serde::{Deserialize, Serialize};

/// The id of a classifier of \[P\]. It stays valid as a name after the classifier was deleted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ClassifierId {
    slot: u32,
    generation: u32,
}

impl ClassifierId {
    /// Returns the id of the classifier at a position of a population from which nothing was removed.
    pub(super) fn first_at(position: usize) -> Self {
        Self {
            slot: position as u32,
            generation: 0,
        }
    }
}

/// The position of each classifier by id.
#[derive(Debug, Clone, Default)]
pub(super) struct Handles {
    /// By slot: the current or next generation, and its position.
    slots: Vec<(u32, u32)>,
    /// By position: the id.
    ids: Vec<ClassifierId>,
    free: Vec<u32>,
}

impl Handles {
    /// Creates an id for the classifier appended at the next position.
    pub fn push(&mut self) -> ClassifierId {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.slots.push((0, 0));
            self.slots.len() as u32 - 1
        });
        let (generation, position) = &mut self.slots[slot as usize];
        *position = self.ids.len() as u32;
        let id = ClassifierId {
            slot,
            generation: *generation,
        };
        self.ids.push(id);
        id
    }

    /// Retires the id at `position`. The last classifier takes that position.
    pub fn swap_remove(&mut self, position: usize) {
        let slot = self.ids.swap_remove(position).slot;
        self.slots[slot as usize].0 += 1;
        self.free.push(slot);
        if let Some(moved) = self.ids.get(position) {
            self.slots[moved.slot as usize].1 = position as u32;
        }
    }

    /// Returns the id of the classifier at `position`.
    #[inline]
    pub fn id_at(&self, position: usize) -> ClassifierId {
        self.ids[position]
    }

    /// Returns the position of a classifier; `None` if it was deleted.
    #[inline]
    pub fn position(&self, id: ClassifierId) -> Option<usize> {
        let &(generation, position) = self.slots.get(id.slot as usize)?;
        (generation == id.generation).then_some(position as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_removed_classifiers_id_stays_dead_after_its_slot_is_reused() {
        let mut handles = Handles::default();
        let [first, second] = [handles.push(), handles.push()];
        handles.swap_remove(0);
        let third = handles.push();
        assert_eq!(third.slot, first.slot, "the slot is reused");
        assert_eq!(handles.position(first), None);
        assert_eq!(handles.position(second), Some(0));
        assert_eq!(handles.position(third), Some(1));
    }

    #[test]
    fn a_removed_classifiers_id_is_dead_while_its_slot_is_free() {
        let mut handles = Handles::default();
        let only = handles.push();
        handles.swap_remove(0);
        assert_eq!(handles.position(only), None);
    }
}
