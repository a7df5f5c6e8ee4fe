#include "tests/fuzz/support/input_folder.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "engine/base/error.h"

namespace shvr::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr size_t MAX_FILES = 64;
constexpr size_t MAX_NAME_BYTES = 64;

bool is_inside(const std::string& name)
{
    if (name.empty() || name.size() > MAX_NAME_BYTES || name.front() == '/' || name.back() == '/') return false;
    if (name.find("..") != std::string::npos || name.find("//") != std::string::npos) return false;
    return std::all_of(name.begin(), name.end(), [](char letter) { return letter > ' ' && letter < 127; });
}

}  // namespace

std::string_view text_of(std::span<const uint8_t> input)
{
    return {reinterpret_cast<const char*>(input.data()), input.size()};
}

std::map<std::string, std::string> unpacked(std::span<const uint8_t> input)
{
    std::map<std::string, std::string> files;
    std::string_view rest = text_of(input);
    std::string name;
    // The mark may be at the very beginning, without a line end before it.
    bool is_first = true;
    while (files.size() < MAX_FILES) {
        size_t end = std::min(rest.size(), rest.find(FILE_MARK));
        size_t skip = FILE_MARK.size();
        if (is_first && rest.starts_with(FILE_MARK.substr(1))) {
            end = 0;
            --skip;
        }
        is_first = false;
        if (!name.empty() || end > 0 || end == rest.size()) files.emplace(name, rest.substr(0, end));
        if (end == rest.size()) break;
        rest.remove_prefix(end + skip);
        const size_t line_end = std::min(rest.size(), rest.find('\n'));
        name = rest.substr(0, line_end);
        if (!is_inside(name)) name = "unnamed";
        rest.remove_prefix(std::min(rest.size(), line_end + 1));
    }
    return files;
}

InputFolder::InputFolder()
{
    std::error_code ignored;
    const fs::path memory = "/dev/shm";
    const bool has_memory = fs::is_directory(memory, ignored) && ::access(memory.c_str(), W_OK) == 0;
    std::string pattern = ((has_memory ? memory : fs::temp_directory_path()) / "shvr_fuzz_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) fail(pattern, ": cannot be made");
    path_ = pattern;
}

InputFolder::~InputFolder()
{
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

void InputFolder::clear() const
{
    for (const auto& entry : fs::directory_iterator(path_)) fs::remove_all(entry.path());
}

fs::path InputFolder::write(const std::string& name, std::string_view content) const
{
    std::error_code ignored;
    fs::create_directories((path_ / name).parent_path(), ignored);
    // A packed file may have the same name as the folder of another: then it is not written.
    std::ofstream file(path_ / name, std::ios::binary);
    file.write(content.data(), std::streamsize(content.size()));
    return path_ / name;
}

void InputFolder::fill(std::span<const uint8_t> input, const std::string& main) const
{
    clear();
    for (const auto& [name, content] : unpacked(input)) write(name.empty() ? main : name, content);
}

const InputFolder& input_folder()
{
    static const InputFolder folder;
    return folder;
}

}  // namespace shvr::fuzz
