//! Straight lines through measured points.

/// A straight line fitted to points with weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FittedLine {
    pub slope: f64,
    pub offset: f64,
    /// Sum of the weighted squares that are left.
    pub misfit: f64,
}

impl FittedLine {
    /// Fits a line to points (x, y, weight) by least squares; `None` if fewer than two differ in x.
    pub(crate) fn fit(points: &[[f64; 3]]) -> Option<Self> {
        let sum = |term: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(term).sum::<f64>();
        let weight = sum(&|p| p[2]);
        let [x, y] = [0, 1].map(|k| sum(&|p| p[2] * p[k]) / weight);
        let across = sum(&|p| p[2] * (p[0] - x).powi(2));
        let slope = sum(&|p| p[2] * (p[0] - x) * (p[1] - y)) / across;
        let offset = y - slope * x;
        let misfit = sum(&|p| p[2] * (p[1] - offset - slope * p[0]).powi(2));
        slope.is_finite().then_some(FittedLine { slope, offset, misfit })
    }
}
