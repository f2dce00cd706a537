//! A progress bar on stderr.

use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use xcscr::episode::{AfterEpisode, Ending, Episode, Observer};

/// The template during the first episode.
const FIRST: &str = "{bar:14} episode {pos}/{len}";
/// The template afterwards: at most 80 columns, for up to 99,999 episodes.
const TEMPLATE: &str = "{bar:14} episode {pos}/{len}, {msg}, {eta} left";

/// Shows the progress of training if stderr is a terminal. The bar is cleared at the end.
pub struct EpisodeProgress {
    bar: ProgressBar,
    best: Option<u32>,
    /// True after the first episode.
    is_under_way: bool,
}

impl EpisodeProgress {
    /// Creates a bar for a number of episodes; `quiet` hides it.
    pub fn of(episodes: u32, quiet: bool) -> Self {
        Self {
            bar: bar(episodes.into(), FIRST, quiet),
            best: None,
            is_under_way: false,
        }
    }
}

/// Returns a bar on stderr, if stderr is a terminal; `quiet` hides it.
pub fn bar(length: u64, template: &str, quiet: bool) -> ProgressBar {
    let target = if quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    ProgressBar::with_draw_target(Some(length), target).with_style(style(template))
}

/// Returns the style of a template.
fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is valid")
}

impl Observer for EpisodeProgress {
    fn ended(&mut self, episode: &Episode, _: &AfterEpisode<'_>) -> ControlFlow<()> {
        if !std::mem::replace(&mut self.is_under_way, true) {
            self.bar.set_style(style(TEMPLATE));
        }
        if episode.ending == Ending::Goal {
            let best = self.best.unwrap_or(u32::MAX).min(episode.steps);
            self.best = Some(best);
        }
        let best = self.best.map_or("none".to_owned(), |best| best.to_string());
        let (steps, collisions) = (episode.steps, episode.collisions);
        self.bar
            .set_message(format!("{steps} steps, {collisions} hits, best {best}"));
        self.bar.inc(1);
        ControlFlow::Continue(())
    }
}

impl Drop for EpisodeProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
