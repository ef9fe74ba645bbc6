//! dev only
mod backend;
mod boundary;
mod field;
pub mod grid;
pub mod hadeler_kuttler;
pub mod lanes;
pub mod limiter;
mod observe;
pub mod raster {
    #[derive(Clone, Debug)]
    pub struct Raster {
        pub columns: usize,
        pub rows: usize,
        pub west: f64,
        pub south: f64,
        pub cell: f64,
        pub values: Vec<f64>,
        pub crs: Option<()>,
    }
    impl Raster { pub fn at(&self, c: usize, r: usize) -> f64 { self.values[r * self.columns + c] } }
}
pub mod real;
pub mod savage_hutter;
pub mod scheme;
pub mod simulation;
pub mod terrain;
pub mod time;
