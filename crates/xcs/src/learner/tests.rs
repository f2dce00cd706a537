//! Tests of the genetic algorithm's effect on the population.

use super::*;

#[test]
fn a_child_of_a_deleted_parent_that_subsumes_it_is_not_lost() {
    let params = Params {
        theta_sub: 20,
        ..Params::default()
    };
    let mut xcs = Xcs::new(params.clone(), 2, Stream::new(1, 0_u64));
    let rule = |condition: &str| Classifier {
        experience: 100,
        error: 0.0,
        ..Classifier::new(
            condition.parse().unwrap(),
            Action::new(0).unwrap(),
            0,
            &params,
        )
    };
    let insert = |xcs: &mut Xcs, condition: &str| {
        let id = xcs.population.insert(rule(condition));
        (id, *xcs.population.get(id).unwrap())
    };
    let parents = [insert(&mut xcs, "1##"), insert(&mut xcs, "11#")];
    let child = rule("111");
    xcs.insert_child(child, &parents);
    assert_eq!(
        xcs.population.get(parents[0].0).unwrap().numerosity,
        2,
        "control"
    );
    // The other parent subsumes the child of a deleted one.
    xcs.population.remove(parents[0].0);
    xcs.insert_child(child, &parents);
    assert_eq!(xcs.population.get(parents[1].0).unwrap().numerosity, 2);
    xcs.population.remove(parents[1].0);
    xcs.insert_child(child, &parents);
    assert_eq!(xcs.population.micro(), 1, "the child is a rule of its own");
}
