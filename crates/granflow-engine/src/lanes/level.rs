//! Which instructions the processor has, and functions in which they are allowed.

#[cfg(any(
    target_arch = "x86",
    target_arch = "x86_64",
    target_arch = "aarch64",
    target_feature = "simd128"
))]
use super::simd::Lanes;
use super::vector::SimdVector;
use fearless_simd::Level;
#[cfg(target_arch = "aarch64")]
use fearless_simd::aarch64::Neon;
#[cfg(target_feature = "simd128")]
use fearless_simd::wasm32::WasmSimd128;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use fearless_simd::x86::{Avx2, Avx512};
use std::marker::PhantomData;

/// The instructions that a step is computed with; the results are the same bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimdLevel {
    /// One cell at a time.
    Scalar,
    /// The widest vectors of this processor: AVX-512, AVX2, NEON or WebAssembly's; one cell at a time where it has none of them.
    Best,
    /// As `Best`, but no wider than AVX2.
    Avx2,
}

/// Work that any kind of lanes can do.
pub(crate) trait SimdKernel {
    /// What it gives.
    type Output;
    /// Do it; `context` calls a function where the instructions of `L` are allowed.
    fn run<L: SimdVector>(self, context: impl SimdContext) -> Self::Output;
}

/// Where the instructions of some lanes are allowed.
pub(crate) trait SimdContext: Copy + Send + Sync {
    /// Call `work` there.
    fn call<T>(self, work: impl FnOnce() -> T) -> T;
}

/// Functions that call another one where some instructions are allowed. What runs on lanes in every row is inlined into them; what
/// is asked once a block may be outside, where each instruction is a call.
///
/// Each kernel has functions of its own, in a module of its own ([`crate::contexts`]): the compiler places what it generates by
/// module, so that it can work on several kernels at a time, and leaves those that have not changed.
///
/// # Safety
/// The processor has the instructions after which a function is named.
pub unsafe trait Contexts: Copy + Send + Sync + 'static {
    /// Are there loops on lanes, or only for one cell at a time?
    const LANES: bool;
    /// Without any.
    fn scalar<T>(work: impl FnOnce() -> T) -> T;
    /// With AVX2.
    ///
    /// # Safety
    /// The processor has it.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    unsafe fn avx2<T>(work: impl FnOnce() -> T) -> T;
    /// With AVX-512.
    ///
    /// # Safety
    /// The processor has it.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    unsafe fn avx512<T>(work: impl FnOnce() -> T) -> T;
    /// With NEON.
    ///
    /// # Safety
    /// The processor has it.
    #[cfg(target_arch = "aarch64")]
    unsafe fn neon<T>(work: impl FnOnce() -> T) -> T;
}

/// A type `Here` that is [`Contexts`], in the module that calls the macro. The features are those of fearless_simd's levels:
/// its functions are inlined only where all of theirs are enabled.
#[doc(hidden)]
#[macro_export]
macro_rules! contexts {
    () => {
        mod scalar {
            #[inline(never)]
            pub fn call<T>(work: impl FnOnce() -> T) -> T {
                work()
            }
        }
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        mod avx2 {
            #[target_feature(enable = "avx2,bmi1,bmi2,cmpxchg16b,f16c,fma,fxsr,lzcnt,movbe,popcnt,xsave")]
            pub fn call<T>(work: impl FnOnce() -> T) -> T {
                work()
            }
        }
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        mod avx512 {
            #[target_feature(
                enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
            )]
            pub fn call<T>(work: impl FnOnce() -> T) -> T {
                work()
            }
        }
        #[cfg(target_arch = "aarch64")]
        mod neon {
            #[target_feature(enable = "neon")]
            pub fn call<T>(work: impl FnOnce() -> T) -> T {
                work()
            }
        }
        $crate::contexts!(@here true);
    };
    // Loops for one cell at a time and no others.
    (scalar) => {
        mod scalar {
            #[inline(never)]
            pub fn call<T>(work: impl FnOnce() -> T) -> T {
                work()
            }
        }
        #[allow(unused_imports, reason = "another processor's")]
        use {scalar as avx2, scalar as avx512, scalar as neon};
        $crate::contexts!(@here false);
    };
    (@here $lanes:literal) => {
        #[derive(Clone, Copy)]
        pub struct Here;

        // SAFETY: each function enables the instructions after which it is named, or none.
        unsafe impl $crate::private::Contexts for Here {
            const LANES: bool = $lanes;
            #[inline(always)]
            fn scalar<T>(work: impl FnOnce() -> T) -> T {
                scalar::call(work)
            }
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            #[inline(always)]
            #[allow(unused_unsafe, reason = "where there are no loops on lanes nothing is asked for")]
            unsafe fn avx2<T>(work: impl FnOnce() -> T) -> T {
                // SAFETY: as the caller promises.
                unsafe { avx2::call(work) }
            }
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            #[inline(always)]
            #[allow(unused_unsafe, reason = "as above")]
            unsafe fn avx512<T>(work: impl FnOnce() -> T) -> T {
                // SAFETY: as the caller promises.
                unsafe { avx512::call(work) }
            }
            #[cfg(target_arch = "aarch64")]
            #[inline(always)]
            #[allow(unused_unsafe, reason = "as above")]
            unsafe fn neon<T>(work: impl FnOnce() -> T) -> T {
                // SAFETY: as the caller promises.
                unsafe { neon::call(work) }
            }
        }
    };
}

macro_rules! context {
    ($(#[$doc:meta])* $context:ident $proof:ty, $function:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub(super) struct $context<C> {
            /// That the processor has them.
            _proof: $proof,
            contexts: PhantomData<C>,
        }
        impl<C: Contexts> $context<C> {
            pub(super) fn new(_proof: $proof) -> Self {
                $context { _proof, contexts: PhantomData }
            }
        }
        impl<C: Contexts> SimdContext for $context<C> {
            #[inline(always)]
            fn call<T>(self, work: impl FnOnce() -> T) -> T {
                #[allow(unused_unsafe, reason = "the scalar context asks for nothing")]
                // SAFETY: there is a proof.
                unsafe {
                    C::$function(work)
                }
            }
        }
    };
}
context! {
    /// Needs no instructions.
    ScalarContext (), scalar
}
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
context! {
    /// AVX2.
    Avx2Context Avx2, avx2
}
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
context! {
    /// AVX-512.
    Avx512Context Avx512, avx512
}
#[cfg(target_arch = "aarch64")]
context! {
    /// NEON.
    NeonContext Neon, neon
}

impl SimdLevel {
    /// Let `job` use the lanes of these instructions, where they are allowed by the functions of `C`.
    pub(crate) fn run<C: Contexts, J: SimdKernel>(self, job: J) -> J::Output {
        if const { !C::LANES } {
            return job.run::<f64>(ScalarContext::<C>::new(()));
        }
        match (self, Level::new()) {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            (SimdLevel::Best, Level::Avx512(simd)) => job.run::<Lanes<Avx512>>(Avx512Context::<C>::new(simd)),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            (SimdLevel::Best | SimdLevel::Avx2, level) if level.as_avx2().is_some() => {
                let simd = level.as_avx2().expect("just seen");
                job.run::<Lanes<Avx2>>(Avx2Context::<C>::new(simd))
            }
            #[cfg(target_arch = "aarch64")]
            (SimdLevel::Best | SimdLevel::Avx2, Level::Neon(simd)) => {
                job.run::<Lanes<Neon>>(NeonContext::<C>::new(simd))
            }
            // A module of WebAssembly has them everywhere or nowhere: loops for one cell at a time would only make it larger.
            #[cfg(target_feature = "simd128")]
            _ => job.run::<Lanes<WasmSimd128>>(ScalarContext::<C>::new(())),
            #[cfg(not(target_feature = "simd128"))]
            _ => job.run::<f64>(ScalarContext::<C>::new(())),
        }
    }
    /// What they are on this processor.
    pub fn found(self) -> &'static str {
        match (self, Level::new()) {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            (SimdLevel::Best, Level::Avx512(_)) => "AVX-512, vectors of 8 cells",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            (SimdLevel::Best | SimdLevel::Avx2, level) if level.as_avx2().is_some() => {
                "AVX2, vectors of 4 cells"
            }
            #[cfg(target_arch = "aarch64")]
            (SimdLevel::Best | SimdLevel::Avx2, Level::Neon(_)) => "NEON, vectors of 2 cells",
            #[cfg(target_feature = "simd128")]
            _ => "WebAssembly, vectors of 2 cells",
            #[cfg(not(target_feature = "simd128"))]
            _ => "scalar, one cell at a time",
        }
    }
}
