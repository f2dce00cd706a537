//! Compact definitions of the well-known protobuf messages.
//!
//! A recording carries each definition twice, one of them uncompressed. The libraries' definitions
//! would be a quarter of the file of an episode of ten steps. The compact ones omit the fields that
//! we never write, and everything that readers do not need: options, JSON names and defaults. The
//! parts of a message are defined inside the message. Readers may put all definitions of a
//! recording into one pool. There a file must be the same for every schema, and a message must not
//! be in two files.

use std::borrow::Cow;
use std::collections::BTreeSet;

use foxglove::Schema;
use prost::Message;
use prost_types::field_descriptor_proto::Label;
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

/// Fields that are never written, by message.
const UNUSED: [(&str, &str); 8] = [
    ("SceneUpdate", "deletions"),
    ("SceneEntity", "lifetime"),
    ("SceneEntity", "metadata"),
    ("SceneEntity", "arrows"),
    ("SceneEntity", "spheres"),
    ("SceneEntity", "models"),
    ("Log", "file"),
    ("Log", "line"),
];
/// Log levels that are never written.
const UNUSED_LEVELS: [&str; 3] = ["DEBUG", "ERROR", "FATAL"];
/// A suffix of part names that readers do not need.
const PRIMITIVE: &str = "Primitive";
const PACKAGE: &str = "foxglove";
const TIME_PACKAGE: &str = "google.protobuf";
const TIME_FILE: &str = "google/protobuf/timestamp.proto";

/// Returns an equivalent definition in fewer bytes.
pub(super) fn short(schema: &Schema) -> Schema {
    let whole = FileDescriptorSet::decode(&*schema.data)
        .expect("well-known schemas are sets of descriptors");
    let name = schema.name.trim_start_matches("foxglove.");
    let used = used(messages(&whole, PACKAGE), name);
    let is_root = |message: &DescriptorProto| message.name() == name;
    let (mut roots, parts): (Vec<_>, Vec<_>) = used.into_iter().partition(is_root);
    roots
        .iter_mut()
        .for_each(|root| root.nested_type.extend(parts.iter().cloned()));
    let mut time = messages(&whole, TIME_PACKAGE);
    time.retain(|message| message.name() == "Timestamp");
    let mut own = file(&format!("{name}.proto"), PACKAGE, roots);
    own.dependency = vec![TIME_FILE.to_owned()];
    let file = vec![file(TIME_FILE, TIME_PACKAGE, time), own];
    Schema {
        data: Cow::Owned(FileDescriptorSet { file }.encode_to_vec()),
        ..schema.clone()
    }
}

/// Returns the messages of a package without the unused parts.
fn messages(set: &FileDescriptorSet, package: &str) -> Vec<DescriptorProto> {
    let files = set.file.iter().filter(|file| file.package() == package);
    let mut found: Vec<_> = files.flat_map(|file| file.message_type.clone()).collect();
    for message in &mut found {
        let name = message.name().to_owned();
        let is_used = |field: &str| !UNUSED.contains(&(name.as_str(), field));
        message.field.retain(|field| is_used(field.name()));
        message.field.iter_mut().for_each(shorten);
        message.name = Some(name.replace(PRIMITIVE, ""));
        for one in &mut message.enum_type {
            one.value
                .retain(|value| !UNUSED_LEVELS.contains(&value.name()));
        }
    }
    found
}

/// Removes redundant attributes from a field.
fn shorten(field: &mut FieldDescriptorProto) {
    field.json_name = None;
    if field.label() == Label::Optional {
        field.label = None;
    }
    if field.type_name.is_some() {
        field.r#type = None;
    }
    // Names without a leading dot are resolved relative to the field first.
    let own = field.type_name.as_deref();
    let own = own.and_then(|name| name.strip_prefix(".foxglove."));
    if let Some(own) = own.map(|name| name.replace(PRIMITIVE, "")) {
        field.type_name = Some(own);
    }
}

/// Returns `root` and the messages that it consists of.
fn used(mut all: Vec<DescriptorProto>, root: &str) -> Vec<DescriptorProto> {
    let (mut used, mut before) = (BTreeSet::from([root.to_owned()]), 0);
    while used.len() > before {
        before = used.len();
        let known = all.iter().filter(|message| used.contains(message.name()));
        let parts = known.flat_map(|message| &message.field);
        let parts: Vec<String> = parts.map(|field| field.type_name().to_owned()).collect();
        used.extend(parts);
    }
    all.retain(|message| used.contains(message.name()));
    all
}

fn file(name: &str, package: &str, messages: Vec<DescriptorProto>) -> FileDescriptorProto {
    FileDescriptorProto {
        name: Some(name.to_owned()),
        package: Some(package.to_owned()),
        syntax: Some("proto3".to_owned()),
        message_type: messages,
        ..FileDescriptorProto::default()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use foxglove::Encode;
    use foxglove::messages::{FrameTransforms, LaserScan, Log, SceneUpdate};

    use super::*;

    fn well_known() -> Vec<Schema> {
        let all = [
            FrameTransforms::get_schema(),
            SceneUpdate::get_schema(),
            Log::get_schema(),
            LaserScan::get_schema(),
        ];
        all.into_iter().flatten().collect()
    }

    /// Returns all messages of a file by full name, including nested ones.
    fn defined(file: &FileDescriptorProto) -> BTreeMap<String, DescriptorProto> {
        let mut left: Vec<(String, &DescriptorProto)> = file
            .message_type
            .iter()
            .map(|message| (file.package().to_owned(), message))
            .collect();
        let mut found = BTreeMap::new();
        while let Some((scope, message)) = left.pop() {
            let name = format!("{scope}.{}", message.name());
            left.extend(message.nested_type.iter().map(|part| (name.clone(), part)));
            found.insert(name, message.clone());
        }
        found
    }

    #[test]
    fn all_definitions_fit_into_one_pool() {
        let (mut files, mut homes) = (BTreeMap::new(), BTreeMap::new());
        for schema in well_known() {
            let short = FileDescriptorSet::decode(&*short(&schema).data).unwrap();
            for file in short.file {
                for name in defined(&file).into_keys() {
                    let home = homes.entry(name.clone());
                    let home = home.or_insert_with(|| file.name().to_owned());
                    assert_eq!(home, file.name(), "{name}");
                }
                let known = files.entry(file.name().to_owned());
                let known = known.or_insert_with(|| file.clone());
                assert_eq!(*known, file);
            }
        }
        assert!(homes.len() > 20, "{homes:?}");
    }

    /// Returns true if the type `part` is found from inside the message `scope` outwards.
    fn is_found(known: &BTreeMap<String, DescriptorProto>, scope: &str, part: &str) -> bool {
        let mut scope = Some(scope);
        while let Some(inner) = scope {
            let (message, last) = part.rsplit_once('.').unwrap_or(("", part));
            let home = format!("{inner}.{message}");
            let enums = known.get(home.trim_end_matches('.'));
            let enums = enums.into_iter().flat_map(|home| &home.enum_type);
            if known.contains_key(&format!("{inner}.{part}"))
                || enums.map(|one| one.name()).any(|name| name == last)
            {
                return true;
            }
            scope = inner.rsplit_once('.').map(|(outer, _)| outer);
        }
        part.strip_prefix('.')
            .is_some_and(|full| known.contains_key(full))
    }

    #[test]
    fn short_definitions_are_complete_and_take_at_most_two_thirds_of_the_bytes() {
        let (mut all_now, mut all_before) = (0, 0);
        for schema in well_known() {
            let short = short(&schema);
            let set = FileDescriptorSet::decode(&*short.data).unwrap();
            let known: BTreeMap<_, _> = set.file.iter().flat_map(defined).collect();
            assert!(known.contains_key(&schema.name), "{}", schema.name);
            for (name, message) in &known {
                let parts = message.field.iter();
                for part in parts.filter_map(|field| field.type_name.as_deref()) {
                    assert!(is_found(&known, name, part), "{part} in {name}");
                }
            }
            assert!(!is_found(&known, &schema.name, "Nothing"));
            let (now, before) = (short.data.len(), schema.data.len());
            assert!(now < before, "{}: {now} of {before}", schema.name);
            all_now += now;
            all_before += before;
        }
        assert!(3 * all_now < 2 * all_before, "{all_now} of {all_before}");
    }
}
