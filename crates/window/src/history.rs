//! The history of visited views, kept as a browser keeps pages.

use super::camera::Camera;

/// Visited views and the index of the one shown.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    views: Vec<Camera>,
    current: usize,
}

/// Largest number of views remembered.
const MAX_VIEWS: usize = 200;

impl History {
    /// Creates a history that begins at a view.
    pub(crate) fn new(first: Camera) -> Self {
        History { views: vec![first], current: 0 }
    }

    /// Records the view at which the camera came to rest; a new one erases the views ahead.
    pub(crate) fn visit(&mut self, camera: Camera) {
        if self.views[self.current] == camera {
            return;
        }
        self.views.truncate(self.current + 1);
        self.views.push(camera);
        if self.views.len() > MAX_VIEWS {
            self.views.remove(0);
        }
        self.current = self.views.len() - 1;
    }

    /// Replaces one view by another wherever it was visited.
    pub(crate) fn replace(&mut self, view: Camera, by: Camera) {
        self.views.iter_mut().filter(|visited| **visited == view).for_each(|visited| *visited = by);
    }

    /// Goes back to the previous view and returns it, if there is one.
    pub(crate) fn back(&mut self) -> Option<Camera> {
        self.current = self.current.checked_sub(1)?;
        Some(self.views[self.current])
    }

    /// Goes forward to the view left by going back and returns it, if there is one.
    pub(crate) fn forward(&mut self) -> Option<Camera> {
        let view = self.views.get(self.current + 1)?;
        self.current += 1;
        Some(*view)
    }

    /// Returns true if there is a previous view.
    pub(crate) fn has_back(&self) -> bool {
        self.current > 0
    }

    /// Returns true if there is a view left by going back.
    pub(crate) fn has_forward(&self) -> bool {
        self.current + 1 < self.views.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reach::Reach;
    use proptest::prelude::*;

    fn view(width_rad: f64) -> Camera {
        Camera { width_rad, ..Camera::whole(Reach::TORUS) }
    }

    proptest! {
        /// Compares the history with the plainest model: two stacks.
        #[test]
        fn it_is_two_stacks(steps in prop::collection::vec(0u8..4, 0..120)) {
            let mut history = History::new(view(0.0));
            let (mut behind, mut here, mut ahead) = (vec![], 0.0, vec![]);
            for (k, step) in steps.into_iter().enumerate() {
                match step {
                    0 => match behind.pop() {
                        Some(width) => {
                            ahead.push(std::mem::replace(&mut here, width));
                            prop_assert_eq!(history.back(), Some(view(here)));
                        }
                        None => prop_assert_eq!(history.back(), None),
                    },
                    1 => match ahead.pop() {
                        Some(width) => {
                            behind.push(std::mem::replace(&mut here, width));
                            prop_assert_eq!(history.forward(), Some(view(here)));
                        }
                        None => prop_assert_eq!(history.forward(), None),
                    },
                    2 => history.visit(view(here)),
                    _ => {
                        behind.push(std::mem::replace(&mut here, k as f64 + 1.0));
                        ahead.clear();
                        history.visit(view(here));
                    }
                }
                prop_assert_eq!(history.has_back(), !behind.is_empty());
                prop_assert_eq!(history.has_forward(), !ahead.is_empty());
            }
        }
    }

    #[test]
    fn the_oldest_are_forgotten() {
        let mut history = History::new(view(1.0));
        (2..1000).for_each(|k| history.visit(view(k as f64)));
        assert_eq!(std::iter::from_fn(|| history.back()).count(), MAX_VIEWS - 1);
    }
}
