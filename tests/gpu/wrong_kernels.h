#pragma once
// Kernels with a deliberate mistake, for this test program alone: its linker sends calls of gpu::embedded_kernels()
// through wrong_kernels.cpp (CMakeLists.txt), and the program that people run has none of this. One thread.

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace shvr {

/// A line of a kernel's source, and its replacement.
struct Mistake {
    const char* name;
    const char* golden;  ///< a golden that must notice
    const char* file;    ///< below shaders/
    const char* right;   ///< stands in the file exactly once
    const char* wrong;
};

/// While it lives, new devices get kernels that are made with the mistake: all of those in `kernels` (names with the
/// suffixes of their variants) whose source includes the file. Fails where the file does not hold `right` exactly once,
/// or where it cannot be compiled.
class WrongKernels {
public:
    WrongKernels(const Mistake& mistake, std::span<const std::string> kernels);
    ~WrongKernels();
    WrongKernels(const WrongKernels&) = delete;
    WrongKernels& operator=(const WrongKernels&) = delete;
    /// How many kernels differ from the right ones.
    size_t count() const { return words_.size(); }

private:
    std::vector<std::vector<uint32_t>> words_;
};

}  // namespace shvr
