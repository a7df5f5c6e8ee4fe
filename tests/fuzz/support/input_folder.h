#pragma once
// Inputs that a reader opens by path. An input may be several files, packed: the bytes up to the first line "@@FILE
// name" are the target's main file; after each such line follows the file it names, up to the line end before the next
// one. So both a bare file and a folder written as names and contents are inputs.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace shvr::fuzz {

inline constexpr std::string_view FILE_MARK = "\n@@FILE ";

/// name -> content; the main file is "". Skips names that lead out of the folder, and long names.
std::map<std::string, std::string> unpacked(std::span<const uint8_t> input);

/// A folder of this process, in memory if the machine has /dev/shm, removed when the process ends.
class InputFolder {
public:
    InputFolder();
    InputFolder(const InputFolder&) = delete;
    ~InputFolder();

    const std::filesystem::path& path() const { return path_; }
    /// Removes everything in it.
    void clear() const;
    std::filesystem::path write(const std::string& name, std::string_view content) const;
    /// Clears it and unpacks `input` into it; the main file is named `main`.
    void fill(std::span<const uint8_t> input, const std::string& main) const;

private:
    std::filesystem::path path_;
};

/// The folder that all inputs of a target share.
const InputFolder& input_folder();

std::string_view text_of(std::span<const uint8_t> input);

}  // namespace shvr::fuzz
