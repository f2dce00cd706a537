use super::*;

fn maze() -> Maze {
    let text = br######"{"rows": ["#####", "#S.G#", "#####"]}"######;
    Maze::from_json(text, "corridor.json").unwrap()
}

fn allele(condition: &str) -> impl Fn(usize) -> Option<bool> {
    move |at| match condition.as_bytes()[at] {
        b'#' => None,
        bit => Some(bit == b'1'),
    }
}

#[test]
fn two_alleles_describe_the_cell_in_a_direction() {
    let alleles = allele("01#0#10#1#00##11");
    let words = Sensor::Neighbours.words(&maze(), &alleles);
    assert_eq!(
        words,
        "north wall, north-east free, east wall or goal, south-east no goal, south goal, \
         south-west free, north-west goal"
    );
}

#[test]
fn a_code_of_no_cell_reads_as_the_learner_interprets_it() {
    let alleles = allele("10##############");
    let words = Sensor::Neighbours.words(&maze(), &alleles);
    assert_eq!(words, "north free (observation error)");
}

#[test]
fn dont_cares_match_anything() {
    let alleles = |_| None;
    for sensor in Sensor::ALL {
        assert_eq!(sensor.words(&maze(), &alleles), "anything");
    }
}

#[test]
fn lidar_words_describe_walls_and_free_cells() {
    let alleles = allele("01#0############");
    let words = Sensor::Lidar.words(&maze(), &alleles);
    assert_eq!(words, "north wall, north-east free");
}

#[test]
fn positions_are_ranges_of_columns_and_rows() {
    let words = |condition: &str| Sensor::Position.words(&maze(), &allele(condition));
    assert_eq!(words("01###"), "column 2 to 3");
    assert_eq!(words("0####"), "column at most 3");
    assert_eq!(words("1####"), "column 4");
    assert_eq!(words("##1#1"), "column 1 or 3, row 1");
    assert_eq!(words("00101"), "column 1, row 1");
    // There are five columns and three rows.
    assert_eq!(words("###1#"), "row 2");
    assert_eq!(words("11###"), "column at least 6 (outside the world)");
    assert_eq!(
        words("1#111"),
        "column 5 or 7 (outside the world), row 3 (outside the world)"
    );
    let alleles = allele("01##############1####");
    let words = Sensor::NeighboursPosition.words(&maze(), &alleles);
    assert_eq!(words, "north wall, column 4");
}

#[test]
fn ranges_of_numbers_are_described_within_the_world() {
    let condition = |text: &str| text.parse::<Condition>().unwrap();
    let words = |sensor: Sensor, text| sensor.words(&maze(), &condition(text));
    let of_position = |text| words(Sensor::Position, text);
    assert_eq!(of_position("[1-2:3]##"), "column 1 to 2");
    assert_eq!(
        of_position("[1-7:3][0-1:2]"),
        "column at least 1, row at most 1"
    );
    assert_eq!(of_position("[0-6:3]##"), "anything");
    let outside = of_position("[5-6:3]##");
    assert_eq!(outside, "column 5 to 6 (outside the world)");
    let around = words(Sensor::LidarPosition, "#1##############[1-2:3][1-2:2]");
    assert_eq!(around, "north wall, column 1 to 2, row at least 1");
}

/// Returns the numbers that the words allow, read as a person would.
fn read(words: &str, count: u32) -> Vec<u32> {
    let number = |text: &str| text.parse::<u32>().unwrap();
    let part = |part: &str| match part.split(' ').collect::<Vec<_>>()[..] {
        ["at", "most", last] => 0..number(last) + 1,
        ["at", "least", first] => number(first)..count,
        [first, "to", last] => number(first)..number(last) + 1,
        [one] => number(one)..number(one) + 1,
        _ => panic!("{part}"),
    };
    words.split(" or ").flat_map(part).collect()
}

#[test]
fn ranges_hold_exactly_the_numbers_that_the_bits_allow() {
    for count in 9..=16_u16 {
        for pattern in 0..81_usize {
            let digit = |at: usize| pattern / 3_usize.pow(at as u32) % 3;
            let alleles = |at: usize| [None, Some(false), Some(true)][digit(at)];
            let allows = |number: &u32| {
                let fits =
                    |at: usize| alleles(at).is_none_or(|one| (number >> (3 - at) & 1 == 1) == one);
                (0..4).all(fits)
            };
            let numbers: Vec<u32> = (0..u32::from(count)).filter(allows).collect();
            match coordinate(count, 0..4, &alleles) {
                None => assert_eq!(numbers.len(), usize::from(count)),
                Some(words) if words.ends_with("(outside the world)") => {
                    assert!(numbers.is_empty())
                }
                Some(words) => assert_eq!(read(&words, u32::from(count)), numbers, "{words}"),
            }
        }
    }
}

#[test]
fn many_ranges_are_abridged() {
    let odd = |at: usize| (at == 5).then_some(true);
    let words = coordinate(64, 0..6, &odd).unwrap();
    assert_eq!(words, "1 or 3 or 5 or ... or 63 (32 in all)");
    let words = coordinate(16, 2..6, &odd).unwrap();
    assert_eq!(words, "1 or 3 or 5 or 7 or 9 or 11 or 13 or 15");
}
