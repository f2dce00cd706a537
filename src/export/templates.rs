//! Templates of exported files, and the source files that they include as they are.

use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, UndefinedBehavior, Value, context};
use serde::Serialize;

/// The templates by name.
const TEMPLATES: [(&str, &str); 3] = [
    ("constants", include_str!("templates/constants.jinja")),
    ("policy.h", include_str!("templates/policy.h.jinja")),
    ("policy.py", include_str!("templates/policy.py.jinja")),
];

/// Declares source files as a table of names and texts.
macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("templates/", $name)))),*]
    };
}

/// The source files that templates include.
const FILES: [(&str, &str); 22] = files![
    "percept.h",
    "masks.h",
    "ranges.h",
    "decide.h",
    "grid.h",
    "goals.h",
    "look_up.h",
    "bits.h",
    "from_map.h",
    "open.h",
    "neighbours.h",
    "lidar.h",
    "percept.py",
    "masks.py",
    "ranges.py",
    "decide.py",
    "grid.py",
    "bits.py",
    "from_map.py",
    "open.py",
    "neighbours.py",
    "lidar.py",
];

/// Renders a template with a model.
pub(super) fn rendered(template: &str, model: &impl Serialize) -> String {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::SemiStrict);
    environment.set_syntax(syntax());
    for (name, text) in TEMPLATES {
        let added = environment.add_template(name, text);
        added.expect("tests render every template");
    }
    let file = Value::from_pairs(FILES);
    let template = environment.get_template(template);
    let text = template.and_then(|template| template.render(context! { file, ..Serde(model) }));
    text.expect("tests render every template")
}

/// Block tags may stand on lines of their own, of which nothing is left.
fn syntax() -> SyntaxConfig {
    let mut builder = SyntaxConfig::builder();
    builder
        .trim_blocks(true)
        .lstrip_blocks(true)
        .keep_trailing_newline(true);
    builder.build().expect("the delimiters are those of Jinja")
}
