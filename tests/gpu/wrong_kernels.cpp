#include "tests/gpu/wrong_kernels.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/gpu/embedded_kernels.h"

using shvr::gpu::EmbeddedKernel;

namespace {

std::vector<EmbeddedKernel> replaced;  ///< empty: the program's own

}  // namespace

// gpu::embedded_kernels(), by the name that the compiler gives it.
extern "C" std::span<const EmbeddedKernel> __real__ZN4shvr3gpu16embedded_kernelsEv();
extern "C" std::span<const EmbeddedKernel> __wrap__ZN4shvr3gpu16embedded_kernelsEv();
std::span<const EmbeddedKernel> __wrap__ZN4shvr3gpu16embedded_kernelsEv()
{
    return replaced.empty() ? __real__ZN4shvr3gpu16embedded_kernelsEv() : std::span<const EmbeddedKernel>(replaced);
}

namespace shvr {

namespace {

namespace fs = std::filesystem;
constexpr int64_t MAX_SHADER_BYTES = 1 << 20;

void put_mistake(const fs::path& file, const Mistake& mistake)
{
    std::string text = read_text(file, MAX_SHADER_BYTES);
    const size_t at = text.find(mistake.right);
    if (at == std::string::npos || text.find(mistake.right, at + 1) != std::string::npos)
        fail("shaders/", mistake.file, " does not hold \"", mistake.right, "\" exactly once; expected the line that '",
             mistake.name, "' changes");
    text.replace(at, std::strlen(mistake.right), mistake.wrong);
    std::ofstream(file) << text;
}

/// "raycast_paged_masked" -> shaders/rays/raycast.comp and PAGED, MASKED: the longest file name that begins it.
std::pair<fs::path, std::string> source_of(const std::string& kernel, const fs::path& shaders)
{
    std::pair<fs::path, std::string> found;
    size_t length = 0;
    for (const auto& entry : fs::recursive_directory_iterator(shaders)) {
        const std::string stem = entry.path().stem().string();
        const bool begins = kernel == stem || kernel.starts_with(stem + "_");
        if (entry.path().extension() != ".comp" || !begins || stem.size() < length) continue;
        length = stem.size();
        found.first = entry.path();
    }
    std::string rest = kernel.substr(length);
    for (char& character : rest) character = char(std::toupper(uint8_t(character)));
    for (size_t at = 0; (at = rest.find('_', at)) != std::string::npos; ++at) rest.replace(at, 1, " -D");
    found.second = rest;
    return found;
}

/// Adds the files that `file` is made of to `names`, relative to `shaders`.
void add_included(const std::string& file, const fs::path& shaders, std::set<std::string>& names)
{
    if (!names.insert(file).second) return;
    const std::string text = read_text(shaders / file, MAX_SHADER_BYTES);
    constexpr std::string_view INCLUDE = "#include \"";
    for (size_t at = text.find(INCLUDE); at != std::string::npos; at = text.find(INCLUDE, at + 1)) {
        const size_t begin = at + INCLUDE.size();
        const std::string name = text.substr(begin, text.find('"', begin) - begin);
        // Beside the file that includes it, or else below shaders/.
        const fs::path beside = (fs::path(file).parent_path() / name).lexically_normal();
        add_included(fs::exists(shaders / beside) ? beside.string() : name, shaders, names);
    }
}

std::vector<uint32_t> compiled(const fs::path& source, const std::string& macros, const fs::path& shaders)
{
    const fs::path binary = shaders / "made.spv";
    const std::string command =
        sentence("shaders/compile_kernel ", source.string(), " ", binary.string(), " -I", shaders.string(), macros);
    if (std::system(command.c_str()) != 0) fail(source.string(), " does not compile with the mistake: ", command);
    const std::vector<std::byte> bytes = read_file(binary, MAX_SHADER_BYTES * 16);
    std::vector<uint32_t> words(bytes.size() / 4);
    std::memcpy(words.data(), bytes.data(), bytes.size());
    return words;
}

}  // namespace

WrongKernels::WrongKernels(const Mistake& mistake, std::span<const std::string> kernels)
{
    const fs::path folder = fs::temp_directory_path() / sentence("shvr-wrong-kernels-", ::getpid());
    fs::remove_all(folder);
    fs::copy("shaders", folder, fs::copy_options::recursive);
    put_mistake(folder / mistake.file, mistake);
    const std::span<const EmbeddedKernel> own = __real__ZN4shvr3gpu16embedded_kernelsEv();
    std::vector<EmbeddedKernel> made(own.begin(), own.end());
    for (const std::string& kernel : kernels) {
        const auto [source, macros] = source_of(kernel, folder);
        std::set<std::string> files;
        add_included(fs::relative(source, folder).string(), folder, files);
        if (!files.contains(mistake.file)) continue;
        std::vector<uint32_t> words = compiled(source, macros, folder);
        const auto is_it = [&](const EmbeddedKernel& each) { return each.name == kernel; };
        const auto place = std::find_if(made.begin(), made.end(), is_it);
        if (place == made.end()) fail(kernel, " is no kernel");
        if (std::equal(words.begin(), words.end(), place->words, place->words + place->word_count)) continue;
        words_.push_back(std::move(words));
        *place = {place->name, words_.back().data(), words_.back().size()};
    }
    fs::remove_all(folder);
    replaced = std::move(made);
}

WrongKernels::~WrongKernels()
{
    replaced.clear();
}

}  // namespace shvr
