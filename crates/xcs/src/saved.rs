//! The saved form of \[P\]: the rules and the eam of each. Rules alone do not store their eam.

use serde::de::{Deserialize, Deserializer, Error};
use serde::{Serialize, Serializer};

use crate::{Population, Representation};

pub fn serialize<C: Representation, S: Serializer>(
    population: &Population<C>,
    to: S,
) -> Result<S::Ok, S::Error> {
    let eams: Vec<f32> = population.rules().iter().map(|rule| rule.eam).collect();
    (population, eams).serialize(to)
}

pub fn deserialize<'de, C: Representation, D: Deserializer<'de>>(
    from: D,
) -> Result<Population<C>, D::Error> {
    let (population, eams): (Population<C>, Vec<f32>) = Deserialize::deserialize(from)?;
    let whole = population.with_eams(&eams);
    whole.ok_or_else(|| D::Error::custom("there must be one eam for each rule"))
}
