//! Rooms by recursive division.

use super::field::Field;
use xcs::random::Stream;

/// A rectangle of free cells: first and last column, first and last row. The first ones are odd.
#[derive(Clone, Copy)]
struct Room {
    cols: [u16; 2],
    rows: [u16; 2],
}

/// Divides the field into rooms by walls, each with one door. Walls are on even coordinates and
/// doors on odd ones, so that no wall ends in a door.
pub fn carve(field: &mut Field, stream: &mut Stream) {
    field.clear();
    let whole = [1, field.last()];
    let mut rooms = vec![Room {
        cols: whole,
        rows: whole,
    }];
    while let Some(room) = rooms.pop() {
        rooms.extend(divide(field, stream, room).into_iter().flatten());
    }
}

/// Divides a room across its longer side; returns `None` if the room is too small.
fn divide(field: &mut Field, stream: &mut Stream, room: Room) -> Option<[Room; 2]> {
    let long = |[first, last]: [u16; 2]| last - first + 1;
    let upright = long(room.cols) >= long(room.rows);
    let (along, across) = match upright {
        true => (room.cols, room.rows),
        false => (room.rows, room.cols),
    };
    // Each part must be at least two cells wide.
    let places: Vec<u16> = (along[0] + 2..along[1].saturating_sub(1))
        .filter(|at| at % 2 == 0)
        .collect();
    let at = *stream.choose(&places)?;
    let doors = usize::from(long(across)).div_ceil(2);
    let door = across[0] + 2 * stream.below(doors) as u16;
    for place in (across[0]..=across[1]).filter(|&place| place != door) {
        match upright {
            true => field.set_wall(at, place, true),
            false => field.set_wall(place, at, true),
        }
    }
    let half = |along| match upright {
        true => Room {
            cols: along,
            ..room
        },
        false => Room {
            rows: along,
            ..room
        },
    };
    Some([half([along[0], at - 1]), half([at + 1, along[1]])])
}
