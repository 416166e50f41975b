//! Contracts of the driver's public items.

// Its compiled driver for the plane and for space is shared, not compiled again.
use moreau as _;

mod along;
mod amplitudes;
mod anisotropic;
mod axis;
mod block;
mod coarse;
mod collapse;
mod corners;
mod doubts;
mod dragged;
mod increments;
mod interrupted;
mod iterates;
mod klarbring;
mod law;
mod moments;
mod panel;
mod passages;
mod plane_stress;
mod refusals;
mod released;
mod seams;
mod slender;
mod stability;
mod states;
mod steps;
mod surfaces;
mod team;
mod thermal;
mod ties;
mod tips;
mod tools;
mod triangles;
