//! The compiled examples of what comes from outside; each checks itself.

#[path = "../../examples/hill48/main.rs"]
mod hill48;
#[path = "../../examples/quad8_by_position.rs"]
mod quad8_by_position;
#[path = "../../examples/saturating_friction.rs"]
mod saturating_friction;

type Fallible = Result<(), Box<dyn std::error::Error>>;

#[test]
fn a_law_from_outside() -> Fallible {
    hill48::main()
}

#[test]
fn an_element_from_outside() -> Fallible {
    quad8_by_position::main()
}

#[test]
fn a_law_of_friction_from_outside() -> Fallible {
    saturating_friction::main()
}
