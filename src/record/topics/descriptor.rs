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
    use foxglove::Encode;
    use foxglove::messages::{FrameTransforms, LaserScan, Log, SceneUpdate};
    use prost_reflect::DescriptorPool;

    use super::*;

    fn well_known() -> Vec<Schema> {
        let all = [
            SceneUpdate::get_schema(),
            FrameTransforms::get_schema(),
            Log::get_schema(),
            LaserScan::get_schema(),
        ];
        all.into_iter().flatten().collect()
    }

    #[test]
    fn short_definitions_fit_into_one_pool_and_take_at_most_two_thirds_of_the_bytes() {
        let (mut now, mut before) = (0, 0);
        let (mut pool, mut time) = (DescriptorPool::new(), None);
        for schema in well_known() {
            let short = short(&schema);
            let mut set = FileDescriptorSet::decode(&*short.data).unwrap();
            let first = set.file.swap_remove(0);
            assert_eq!(*time.get_or_insert(first.clone()), first, "the shared file");
            pool.decode_file_descriptor_set(&*short.data).unwrap();
            let found = pool.get_message_by_name(&schema.name);
            assert!(found.is_some(), "{}", schema.name);
            assert!(short.data.len() < schema.data.len(), "{}", schema.name);
            now += short.data.len();
            before += schema.data.len();
        }
        assert!(pool.all_messages().count() > 20);
        assert!(3 * now < 2 * before, "{now} of {before}");
    }

    #[test]
    fn a_definition_that_lacks_a_part_is_refused() {
        let short = short(&well_known()[0]);
        let mut set = FileDescriptorSet::decode(&*short.data).unwrap();
        assert!(DescriptorPool::from_file_descriptor_set(set.clone()).is_ok());
        for message in set.file.iter_mut().flat_map(|file| &mut file.message_type) {
            message.nested_type.pop();
        }
        assert!(DescriptorPool::from_file_descriptor_set(set).is_err());
    }
}
