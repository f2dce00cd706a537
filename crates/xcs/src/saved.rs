//! \[P\] with the eam of each rule, which rules by themselves leave out, as checkpoints store it.

use serde::de::{Deserialize, Deserializer, Error};
use serde::{Serialize, Serializer};

use crate::Population;

pub fn serialize<S: Serializer>(population: &Population, to: S) -> Result<S::Ok, S::Error> {
    let eams: Vec<f32> = population.rules().iter().map(|rule| rule.eam).collect();
    (population, eams).serialize(to)
}

pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Population, D::Error> {
    let (population, eams): (Population, Vec<f32>) = Deserialize::deserialize(from)?;
    let whole = population.with_eams(&eams);
    whole.ok_or_else(|| D::Error::custom("there must be one eam for each rule"))
}
