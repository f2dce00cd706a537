const SIDE: usize = 2 * SCAN_REACH as usize + 1;
/// A cell is free if its evidence exceeds this.
const FREE: i32 = 30;
/// Evidence of a beam that came back, and of a beam that did not.
const HIT: i32 = 20;
const LOST: i32 = 7;
/// In cells smaller than 1 m, the two lengths below are reduced in proportion.
const SCALE: f64 = if CELL_SIZE_M < 1.0 { CELL_SIZE_M } else { 1.0 };
/// The least distance that a beam must travel in a cell to give evidence about it: metres, plus a
/// share of its range.
const GRAZE_M: f64 = 0.15 * SCALE;
const GRAZE_SHARE: f64 = 0.02;
/// A beam is an outlier if its end is farther than this from every line of the grid, in metres.
const STRAY_M: f64 = 0.2 * SCALE;
/// Ranges of this many metres or more mean that nothing came back.
const MOST_M: f64 = 1e4;

/// A percept from a scan. Begin at the estimated pose, add the beams one by one, and read the
/// percept.
///
/// Begin a new scan with each action. If the robot moves during the scan, call `move_to` with the
/// pose of each beam before adding the beam, and at the end with the final pose of the robot. Walls
/// are on the lines of the grid. A cell with too little evidence counts as a wall.
#[derive(Clone)]
pub struct Scan {
    /// The pose of the next beams in the grid frame: metres, cosine and sine of the heading.
    position: [f64; 2],
    heading: [f64; 2],
    /// The cell in which the scan began, and the cell of the pose, to the east and to the north.
    middle: [i32; 2],
    here: [i32; 2],
    evidence: [[i32; SIDE]; SIDE],
}

impl Scan {
    /// Begins a scan at a pose of the map frame: metres, cosine and sine of the heading.
    pub fn begin(x_m: f64, y_m: f64, cosine: f64, sine: f64) -> Self {
        let mut scan = Self {
            position: [0.0; 2],
            heading: [1.0, 0.0],
            middle: [0; 2],
            here: [0; 2],
            evidence: [[0; SIDE]; SIDE],
        };
        scan.move_to(x_m, y_m, cosine, sine);
        scan.middle = scan.here;
        scan
    }

    /// Sets the pose of the next beams in the map frame: metres, cosine and sine of the heading.
    pub fn move_to(&mut self, x_m: f64, y_m: f64, cosine: f64, sine: f64) {
        self.position = grid_from_map(x_m, y_m);
        self.heading = [
            cosine * ORIGIN_COSINE + sine * ORIGIN_SINE,
            sine * ORIGIN_COSINE - cosine * ORIGIN_SINE,
        ];
        self.here = self.position.map(|at_m| floor(at_m / CELL_SIZE_M));
    }

    /// Adds a beam: cosine and sine of its bearing, counter-clockwise from the heading, and its range in
    /// metres, as in a LaserScan message (REP 117). Infinity or `None` means that nothing came back. A range below
    /// the lidar's shortest one, such as 0 or minus infinity, means that something is too near to be measured.
    /// NaN adds nothing.
    pub fn add(&mut self, cosine: f64, sine: f64, range_m: Option<f64>) {
        if range_m.is_some_and(f64::is_nan) {
            return;
        }
        let came_back = range_m.filter(|&range| range < MOST_M);
        let (weight, range) = match came_back {
            Some(range) => (HIT, range.max(SCAN_NEAREST_M)),
            None => (LOST, SCAN_LOST_RANGE_M),
        };
        let graze = GRAZE_M + GRAZE_SHARE * range;
        let [ahead, aside] = self.heading;
        let mut x = Axis::new(self.position[0], ahead * cosine - aside * sine);
        let mut y = Axis::new(self.position[1], ahead * sine + aside * cosine);
        let mut entered = 0.0;
        // Cells beyond those of the scan do not matter.
        while let Some(cell) = self.index(x.cell, y.cell) {
            let left = x.next.min(y.next);
            if left.is_nan() || left > range + STRAY_M {
                return;
            }
            if x.next < y.next {
                x.cross()
            } else {
                y.cross()
            }
            let following = x.next.min(y.next);
            let ends = came_back.is_some() && range < (left + following) / 2.0;
            if ends && (left - range > STRAY_M || range - left > STRAY_M) {
                return;
            }
            let stay = left - entered;
            if stay > graze {
                self.mark(cell, weight);
            }
            if ends {
                // Near a corner the beam may have ended in the cell before or behind.
                let is_wall = following - left > graze && (entered <= 0.0 || stay > graze);
                if let Some(cell) = self.index(x.cell, y.cell).filter(|_| is_wall) {
                    self.mark(cell, -HIT);
                }
                return;
            }
            entered = left;
        }
    }

    /// Returns the percept at the current pose.
    pub fn percept(&self) -> Percept {
        let [east, north] = self.here;
        let column = east.clamp(0, i32::from(COLUMNS) - 1) as u16;
        let row = (i32::from(ROWS) - 1 - north).clamp(0, i32::from(ROWS) - 1) as u16;
        let mut percept = percept_in(column, row);
        set_ring(&mut percept, |x, y| {
            let cell = self.index(self.here[0] + x, self.here[1] + y);
            cell.is_some_and(|[x, y]| self.evidence[x][y] > FREE)
        });
        percept
    }

    /// Returns the index of the evidence about a cell, if the scan stores it.
    fn index(&self, column: i32, row: i32) -> Option<[usize; 2]> {
        let index =
            [column - self.middle[0], row - self.middle[1]].map(|at| (at + SCAN_REACH) as usize);
        index.iter().all(|&at| at < SIDE).then_some(index)
    }

    fn mark(&mut self, [x, y]: [usize; 2], evidence: i32) {
        self.evidence[x][y] = self.evidence[x][y].saturating_add(evidence);
    }
}

/// A ray along one axis.
struct Axis {
    cell: i32,
    step: i32,
    /// Distance along the ray to the next cell boundary.
    next: f64,
    /// Distance along the ray between two cell boundaries.
    every: f64,
}

impl Axis {
    fn new(origin: f64, direction: f64) -> Self {
        let cell = floor(origin / CELL_SIZE_M);
        let (step, next, per_metre) = if direction > 0.0 {
            let per_metre = 1.0 / direction;
            (
                1,
                ((f64::from(cell) + 1.0) * CELL_SIZE_M - origin) * per_metre,
                per_metre,
            )
        } else if direction < 0.0 {
            let per_metre = 1.0 / -direction;
            (
                -1,
                (origin - f64::from(cell) * CELL_SIZE_M) * per_metre,
                per_metre,
            )
        } else {
            (0, f64::INFINITY, 1.0)
        };
        Self {
            cell,
            step,
            next,
            every: CELL_SIZE_M * per_metre,
        }
    }

    fn cross(&mut self) {
        self.cell += self.step;
        self.next += self.every;
    }
}
