//! Counts of the outcomes of a test.

/// Counts of the outcomes of a test.
#[derive(Clone, Debug, Default)]
pub struct Count {
    /// Rays that were compared.
    pub rays: u64,
    /// Those that lie in a surface.
    pub in_surface: u64,
    /// Those that cross several surfaces or leaves at one time.
    pub ties: u64,
    /// Those that touch a surface.
    pub touching: u64,
    /// Those without any coincidence.
    pub plain: u64,
    /// Expected crossings.
    pub crossings: u64,
    /// Rays without a certain answer, mostly because the depth of a piece is close to the tolerance.
    pub redrawn: u64,
    /// Rays within 1e-9 of an edge or a tangency, and how many of them have a different answer (rotated models only).
    pub near_edges: (u64, u64),
    /// Rays with a different answer that cross two surfaces at one time within rounding, at very different angles.
    pub torn: u64,
    /// Wrong answers.
    pub wrong: u64,
    /// The first wrong answer of each model, with its seed.
    pub messages: Vec<(u64, String)>,
}

impl Count {
    /// Adds the counts of another part of the test.
    pub fn add(&mut self, other: Count) {
        self.rays += other.rays;
        self.in_surface += other.in_surface;
        self.ties += other.ties;
        self.touching += other.touching;
        self.plain += other.plain;
        self.crossings += other.crossings;
        self.redrawn += other.redrawn;
        self.near_edges.0 += other.near_edges.0;
        self.near_edges.1 += other.near_edges.1;
        self.torn += other.torn;
        self.wrong += other.wrong;
        self.messages.extend(other.messages);
    }

    /// Panics if any answer was wrong or if there were fewer than `least` rays.
    pub fn finish(self, what: &str, least: u64) {
        let summary = Count { messages: Vec::new(), ..self.clone() };
        println!("{what}: {summary:?}");
        let messages = self.messages.iter().take(5).map(|(seed, what)| format!("\nseed {seed}: {what}\n---"));
        assert!(self.wrong == 0, "{what}: {summary:?}{}", messages.collect::<String>());
        assert!(self.rays >= least, "{what}: only {} rays", self.rays);
    }
}
