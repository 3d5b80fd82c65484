//! Proof kill.
pub fn run(_: &str, _: &[&str]) -> Result<(), Box<dyn std::error::Error>> {
    Err("not yet".into())
}
