//! What became of the rays asked.

/// What became of the rays asked.
#[derive(Clone, Debug, Default)]
pub struct Count {
    /// Answered, and compared.
    pub rays: u64,
    /// Of these: in a surface.
    pub lying: u64,
    /// Of these: crossing several surfaces or leaves at once.
    pub ties: u64,
    /// Of these: touching a surface.
    pub touching: u64,
    /// Of these: none of that.
    pub plain: u64,
    /// Crossings expected.
    pub crossings: u64,
    /// Drawn again because a piece is about as deep as the tolerance.
    pub redrawn: u64,
    /// Within 1e-9 of an edge or a tangency, with another answer (turned models only).
    pub near_edges: (u64, u64),
    /// With another answer where two surfaces are met at once within rounding, at very different angles.
    pub torn: u64,
    /// Wrong.
    pub wrong: u64,
    /// The first wrong one of each model, by its seed.
    pub messages: Vec<(u64, String)>,
}

impl Count {
    /// Adds what another part of a run counted.
    pub fn add(&mut self, other: Count) {
        self.rays += other.rays;
        self.lying += other.lying;
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

    /// Panics if anything was wrong or too few rays were asked.
    pub fn finish(self, what: &str, least: u64) {
        let summary = Count { messages: Vec::new(), ..self.clone() };
        println!("{what}: {summary:?}");
        let told = self.messages.iter().take(5).map(|(seed, what)| format!("\nseed {seed}: {what}\n---"));
        assert!(self.wrong == 0, "{what}: {summary:?}{}", told.collect::<String>());
        assert!(self.rays >= least, "{what}: only {} rays", self.rays);
    }
}
