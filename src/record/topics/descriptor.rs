//! The definitions of well-known messages, in as few bytes as say it.
//!
//! A recording carries each definition twice, and an episode may have ten steps only: as the
//! libraries have them, they would be a quarter of its file. Left out are fields that we never
//! write, and what no reader needs: options, and names for JSON. Messages share files as far as
//! they can: readers put all definitions of a recording into one pool, in which a file must be the
//! same whoever brings it, and a message must not be in two.

use std::borrow::Cow;
use std::collections::BTreeSet;

use foxglove::Schema;
use prost::Message;
use prost_types::{DescriptorProto, FileDescriptorProto, FileDescriptorSet};

/// Fields that are never written, by their message.
const UNUSED: [(&str, &str); 5] = [
    ("SceneUpdate", "deletions"),
    ("SceneEntity", "lifetime"),
    ("SceneEntity", "metadata"),
    ("SceneEntity", "spheres"),
    ("SceneEntity", "models"),
];
/// Messages that several well-known ones are made of; each has a file of its own.
const SHARED: [&str; 3] = ["Vector3", "Quaternion", "Pose"];
const PACKAGE: &str = "foxglove";
const OF_TIME: &str = "google.protobuf";
const TIME_FILE: &str = "google/protobuf/timestamp.proto";

/// The same definition of the same messages in fewer bytes.
pub(super) fn short(schema: &Schema) -> Schema {
    let whole = FileDescriptorSet::decode(&*schema.data)
        .expect("well-known schemas are sets of descriptors");
    let root = schema.name.trim_start_matches("foxglove.");
    let used = used(messages(&whole, PACKAGE), root);
    let is_shared = |message: &DescriptorProto| SHARED.contains(&message.name());
    let (shared, own): (Vec<_>, Vec<_>) = used.into_iter().partition(is_shared);
    let mut time = messages(&whole, OF_TIME);
    time.retain(|message| message.name() == "Timestamp");
    let mut files = vec![file(TIME_FILE, OF_TIME, time)];
    // A pose consists of the other two.
    for message in shared {
        let name = format!("{PACKAGE}/{}.proto", message.name());
        let mut file = file(&name, PACKAGE, vec![message.clone()]);
        file.dependency = match message.name() {
            "Pose" => files[1..]
                .iter()
                .map(|file| file.name().to_owned())
                .collect(),
            _ => Vec::new(),
        };
        files.push(file);
    }
    let mut own = file(&format!("{PACKAGE}/{root}.proto"), PACKAGE, own);
    own.dependency = files.iter().map(|file| file.name().to_owned()).collect();
    files.push(own);
    Schema {
        data: Cow::Owned(FileDescriptorSet { file: files }.encode_to_vec()),
        ..schema.clone()
    }
}

/// The messages of a package, without what is not needed.
fn messages(set: &FileDescriptorSet, package: &str) -> Vec<DescriptorProto> {
    let files = set.file.iter().filter(|file| file.package() == package);
    let mut found: Vec<_> = files.flat_map(|file| file.message_type.clone()).collect();
    for message in &mut found {
        let name = message.name().to_owned();
        let is_used = |field: &str| !UNUSED.contains(&(name.as_str(), field));
        message.field.retain(|field| is_used(field.name()));
        for field in &mut message.field {
            field.json_name = None;
            // Names without a dot in front are looked up in the package first.
            let own = field.type_name.as_deref();
            let own = own.and_then(|name| name.strip_prefix(".foxglove."));
            if let Some(own) = own.map(str::to_owned) {
                field.type_name = Some(own);
            }
        }
    }
    found
}

/// Those of which `root` and its parts consist.
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
    use foxglove::messages::{FrameTransforms, Grid, LaserScan, Log, SceneUpdate};

    use super::*;

    fn well_known() -> Vec<Schema> {
        let all = [
            FrameTransforms::get_schema(),
            SceneUpdate::get_schema(),
            Grid::get_schema(),
            Log::get_schema(),
            LaserScan::get_schema(),
        ];
        all.into_iter().flatten().collect()
    }

    #[test]
    fn all_definitions_fit_into_one_pool() {
        let (mut files, mut homes) = (BTreeMap::new(), BTreeMap::new());
        for schema in well_known() {
            let short = FileDescriptorSet::decode(&*short(&schema).data).unwrap();
            for file in short.file {
                for message in &file.message_type {
                    let name = format!("{}.{}", file.package(), message.name());
                    let home = homes.entry(name).or_insert_with(|| file.name().to_owned());
                    assert_eq!(home, file.name(), "{}", message.name());
                }
                let known = files.entry(file.name().to_owned());
                let known = known.or_insert_with(|| file.clone());
                assert_eq!(*known, file);
            }
        }
        assert!(homes.len() > 20, "{homes:?}");
    }

    #[test]
    fn a_definition_has_all_that_it_names_and_all_of_them_two_thirds_of_the_bytes_at_most() {
        let (mut all_now, mut all_before) = (0, 0);
        for schema in well_known() {
            let short = short(&schema);
            let set = FileDescriptorSet::decode(&*short.data).unwrap();
            let defined: Vec<&str> = set
                .file
                .iter()
                .flat_map(|f| &f.message_type)
                .map(|m| m.name())
                .collect();
            for message in set.file.iter().flat_map(|file| &file.message_type) {
                let nested: Vec<&str> = message.enum_type.iter().map(|one| one.name()).collect();
                for part in message
                    .field
                    .iter()
                    .filter_map(|field| field.type_name.as_deref())
                {
                    let name = part.rsplit('.').next().unwrap();
                    assert!(defined.contains(&name) || nested.contains(&name), "{part}");
                }
            }
            let (now, before) = (short.data.len(), schema.data.len());
            assert!(now < before, "{}: {now} of {before}", schema.name);
            all_now += now;
            all_before += before;
        }
        assert!(3 * all_now < 2 * all_before, "{all_now} of {all_before}");
    }
}
