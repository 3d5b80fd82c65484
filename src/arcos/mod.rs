//! ARCOS
