"""Making the libraries of compiled kernels: for developers, with numba and LLVM's linker ``ld.lld``."""
