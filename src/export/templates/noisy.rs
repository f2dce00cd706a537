/// Localisation with observation errors.
impl Tracker {
    /// Updates the belief. Each state is weighted by its prediction and by the number of
    /// observation errors that it implies. With a small probability the robot is in any state.
    fn locate(&mut self, percept: u16, bumped: bool, rewarded: bool) {
        let fits = |from: usize, _: &State, to: u16| {
            IGNORES_COLLISIONS || (from == usize::from(to)) == bumped
        };
        let (expects, mislocalised) = match self.action {
            Some(action) => {
                self.found = (self.found + u8::from(rewarded)).min(REWARDS);
                (self.follow(action, fits), MISLOCALISED)
            }
            None => {
                self.next = self.belief;
                (self.likeliest().is_some(), BEGUN_ELSEWHERE)
            }
        };
        let mislocalised = if expects { mislocalised } else { 1.0 };
        for (at, state) in STATE_TABLE.iter().enumerate() {
            let wrong =
                differences(state.percept, percept) + u8::from(found_in(state) != self.found);
            let likely = (0..wrong).fold(1.0, |likely, _| likely * OBSERVATION_ERROR);
            let weight = self.next[at] * (1.0 - mislocalised) + mislocalised / STATES as f64;
            self.belief[at] = weight * likely;
        }
        settle(&mut self.belief);
        let likeliest = self.likeliest();
        self.percept = likeliest.map_or(percept, |at| STATE_TABLE[usize::from(at)].percept);
    }
}
