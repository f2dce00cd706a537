//! Recordings for ROS 2: its encoding byte by byte, and the same bytes again.

use mcap::MessageStream;
use xcscr::run::Source;

use crate::PHYSICS;
use crate::kit::desk::Desk;

/// The fields of a message as CDR lays them out: each at a multiple of its size.
struct Cdr<'a>(&'a [u8], usize);

impl Cdr<'_> {
    fn bytes(&mut self, size: usize) -> &[u8] {
        let from = self.1.next_multiple_of(size);
        self.1 = from + size;
        &self.0[from..self.1]
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes(4).try_into().unwrap())
    }

    fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.bytes(8).try_into().unwrap())
    }

    /// A text, which ends with a zero.
    fn text(&mut self) -> String {
        let length = self.u32() as usize;
        let text = &self.0[self.1..self.1 + length];
        assert_eq!(text.last(), Some(&0), "{text:?}");
        self.1 += length;
        String::from_utf8(text[..length - 1].to_vec()).unwrap()
    }
}

#[test]
fn a_recording_for_ros_has_its_encoding_and_the_same_bytes_again() {
    let desk = Desk::new();
    let run = desk.train("run", PHYSICS);
    let ros = "recording ros @run/ep-0002.mcap -o @bag.mcap";
    desk.ok(ros);
    desk.run(73, ros);

    let bytes = desk.read("bag.mcap");
    let source = Source::of(&run.join("ep-0002.mcap")).unwrap();
    assert!(bytes == source.ros_bag().unwrap(), "other bytes");
    let messages: Vec<mcap::Message> = MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    let first = |topic: &str| messages.iter().find(|m| m.channel.topic == topic).unwrap();
    let transforms = first("/tf");
    let schema = transforms.channel.schema.as_ref().unwrap();
    assert_eq!(
        (&*schema.name, &*schema.encoding),
        ("tf2_msgs/msg/TFMessage", "ros2msg")
    );
    assert_eq!(transforms.channel.message_encoding, "cdr");
    assert_eq!(transforms.data[..4], [0, 1, 0, 0], "little-endian");
    let mut cdr = Cdr(&transforms.data[4..], 0);
    assert_eq!(cdr.u32(), 2, "map to odom, and odom to base_link");
    let (seconds, rest_ns) = (cdr.u32(), cdr.u32());
    let stamp_ns = u64::from(seconds) * 1_000_000_000 + u64::from(rest_ns);
    assert_eq!(stamp_ns, transforms.log_time);
    assert_eq!(
        (cdr.text(), cdr.text()),
        ("map".to_owned(), "odom".to_owned())
    );
    // The start of Maze4 is the middle of cell 1,1, counted from the upper left; east is 0.
    let numbers: Vec<f64> = (0..7).map(|_| cdr.f64()).collect();
    assert_eq!(numbers, [1.5, 6.5, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let times: Vec<u64> = messages.iter().map(|message| message.log_time).collect();
    assert!(times.is_sorted(), "messages out of the order of time");
    for (topic, durability) in [("/map", 1), ("/tf_static", 1), ("/tf", 2), ("/scan", 2)] {
        let of_topic = messages.iter().filter(|m| m.channel.topic == topic);
        assert_eq!(of_topic.count() == 1, durability == 1, "{topic}");
        let qos = &first(topic).channel.metadata["offered_qos_profiles"];
        assert!(
            qos.contains(&format!("\n  durability: {durability}\n")),
            "{topic}: {qos}"
        );
    }
}
