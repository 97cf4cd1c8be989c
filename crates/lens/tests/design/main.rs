//! Prescriptions, their paraxial data, and what is made of the rays traced through them, against closed forms and peers.

mod analysis;
mod aspheres;
mod benches;
mod breaks;
mod designs;
mod figures;
mod lenses;
mod optimum;
mod paraxial;
mod prescription;
mod terms;
mod tolerances;
mod zmx;
