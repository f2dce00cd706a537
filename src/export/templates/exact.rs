/// Localisation with percepts without errors, which also show a collision.
impl Tracker {
    fn locate(&mut self, percept: u16, _bumped: bool, rewarded: bool) {
        self.percept = percept;
        let looks = |state: &State, found: u8| state.percept == percept && found_in(state) == found;
        let Some(action) = self.action else {
            let mut believed = (0..STATES).filter(|&at| self.belief[at] > NONE).peekable();
            let any = believed.peek().is_some();
            if !any || !believed.all(|at| looks(&STATE_TABLE[at], self.found)) {
                self.look_around(percept);
            }
            return;
        };
        // A reward that was not predicted, or did not come, still gives evidence about the state.
        for found in [
            self.found + u8::from(rewarded),
            self.found + u8::from(!rewarded),
        ] {
            if self.follow(action, |_, state, _| looks(state, found)) {
                self.belief = self.next;
                self.found = found;
                return;
            }
        }
        self.found = (self.found + u8::from(rewarded)).min(REWARDS);
        self.look_around(percept);
    }

    /// Spreads the belief over all states whose percept differs least.
    fn look_around(&mut self, percept: u16) {
        let found = self.found;
        let strange = |state: &State| match found_in(state) == found {
            true => differences(state.percept, percept),
            false => u8::MAX,
        };
        let least = STATE_TABLE.iter().map(strange).min().unwrap_or(u8::MAX);
        for (state, weight) in STATE_TABLE.iter().zip(&mut self.belief) {
            *weight = Weight::from(u8::from(least < u8::MAX && strange(state) == least));
        }
        settle(&mut self.belief);
    }
}
