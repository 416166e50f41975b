//! Contracts of the driver's public items.

mod along;
mod amplitudes;
mod anisotropic;
mod axis;
mod block;
mod coarse;
mod collapse;
mod corners;
mod doubts;
mod examples;
mod increments;
mod interrupted;
mod klarbring;
mod law;
mod panel;
mod passages;
mod plane_stress;
mod refusals;
mod released;
mod seams;
mod slender;
mod states;
mod steps;
mod surfaces;
mod team;
mod tools;
