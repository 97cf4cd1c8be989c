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
    /// The first wrong ones.
    pub messages: Vec<String>,
}

impl Count {
    /// Panics if anything was wrong or too few rays were asked.
    pub fn finish(self, what: &str, least: u64) {
        let summary = Count { messages: Vec::new(), ..self.clone() };
        println!("{what}: {summary:?}");
        assert!(self.wrong == 0, "{what}: {summary:?}\n{}", self.messages.join("\n---\n"));
        assert!(self.rays >= least, "{what}: only {} rays", self.rays);
    }
}
