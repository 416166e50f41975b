//! The laws against what they promise: inequalities, known answers, derivatives by differences;
//! not fields or structures.

mod anisotropic;
mod armstrong_frederick;
mod cam_clay;
mod contract;
mod coulomb;
mod data;
mod drucker_prager;
mod flow_power;
mod friction;
mod hardening;
mod large;
mod lemaitre;
mod material_point;
mod natural_map;
mod orthotropic;
mod panel;
mod plane_stress;
mod potential;
mod projection;
mod regularised;
mod samples;
mod slider;
mod standard;
mod wrong;
