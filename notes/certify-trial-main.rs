#![allow(dead_code)]
pub use stead::robot;
pub use stead::task;
pub mod placement {
    pub use stead::placement::*;
    #[path = "/tmp/w-cert/src/placement/certify/mod.rs"]
    pub mod certify;
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let run = stead::config::read_run(std::path::Path::new(&a[1])).unwrap();
    let incumbent: f64 = a[2].parse::<f64>().unwrap() * 1e-3;
    let gap: f64 = a[3].parse::<f64>().unwrap() * 1e-2;
    let step: f64 = a[4].parse::<f64>().unwrap() * 1e-3;
    let headings: usize = a[5].parse().unwrap();
    let rate = a[6] == "rate";
    placement::certify::search::trial(&run.problem, step, headings, rate, incumbent, gap, a[7].parse().unwrap());
}
