//! Lens design: prescriptions, paraxial data, image analysis, optimisation and tolerancing, compared with
//! closed forms and other programs.

mod analysis;
mod aspheres;
mod benches;
mod breaks;
mod designs;
mod figures;
mod lenses;
mod operands;
mod optimum;
mod paraxial;
mod prescription;
mod stops;
mod terms;
mod tolerances;
mod zmx;
