#pragma once
// Inputs that a reader opens by path. An input may be several files, packed: the bytes up to the first line
// "@@FILE name" are the target's main file, those behind each such line the file it names, to the line end before the
// next one. So a bare file is an input as it is, and so is a folder that is written as names and contents.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace shvr::fuzz {

inline constexpr std::string_view FILE_MARK = "\n@@FILE ";

/// name -> content; the main file is "". Names that lead out of the folder, or that are long, are left out.
std::map<std::string, std::string> unpacked(std::span<const uint8_t> input);

/// A folder of this process, in memory where the machine has /dev/shm, that is gone when the process ends.
class InputFolder {
public:
    InputFolder();
    InputFolder(const InputFolder&) = delete;
    ~InputFolder();

    const std::filesystem::path& path() const { return path_; }
    /// Takes away everything in it.
    void clear() const;
    std::filesystem::path write(const std::string& name, std::string_view content) const;
    /// Clears it and writes what is packed in `input`, under `main` what is behind no name.
    void fill(std::span<const uint8_t> input, const std::string& main) const;

private:
    std::filesystem::path path_;
};

/// The one that all inputs of a target share.
const InputFolder& input_folder();

std::string_view text_of(std::span<const uint8_t> input);

}  // namespace shvr::fuzz
