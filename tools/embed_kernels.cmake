# Writes OUTPUT, a C++ file that holds the SPIR-V files BINARIES as arrays, so that `shvr` is one file that runs from
# anywhere, and the macros that a kernel may be compiled with. Run by the build:
# cmake -DOUTPUT=... -DBINARIES=a.spv;b.spv "-DVARIANTS=raycast PAGED MASKED;surfaces LISTED" -P embed_kernels.cmake
set(arrays "")
set(entries "")
foreach(binary IN LISTS BINARIES)
    cmake_path(GET binary STEM name)
    file(READ ${binary} bytes HEX)
    # SPIR-V is a stream of 32-bit words, here little-endian, as glslang writes it on every machine we build on.
    string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
    string(APPEND arrays "constexpr uint32_t ${name}_words[] = {${words}};\n")
    string(APPEND entries "    {\"${name}\", ${name}_words, std::size(${name}_words)},\n")
endforeach()
set(variants "")
foreach(line IN LISTS VARIANTS)
    string(REPLACE " " ";" macros "${line}")
    list(POP_FRONT macros name)
    list(TRANSFORM macros REPLACE "(.+)" "\"\\1\"")
    list(JOIN macros ", " macros)
    string(APPEND arrays "constexpr std::string_view ${name}_macros[] = {${macros}};\n")
    string(APPEND variants "    {\"${name}\", ${name}_macros},\n")
endforeach()
set(kernel_variants "{}")
if(variants)
    string(APPEND arrays "constexpr KernelVariants variants[] = {\n${variants}};\n")
    set(kernel_variants "gpu::variants")
endif()
set(kernels "{}")
if(entries)
    string(APPEND arrays "constexpr EmbeddedKernel kernels[] = {\n${entries}};\n")
    set(kernels "kernels")
endif()
file(WRITE ${OUTPUT} "// Made by tools/embed_kernels.cmake.
#include \"engine/gpu/embedded_kernels.h\"
#include \"engine/graph/kernel_variants.h\"

#include <iterator>

namespace shvr::gpu {
namespace {
${arrays}}  // namespace

std::span<const EmbeddedKernel> embedded_kernels()
{
    return ${kernels};
}

}  // namespace shvr::gpu

namespace shvr {

std::span<const KernelVariants> kernel_variants()
{
    return ${kernel_variants};
}

}  // namespace shvr
")
