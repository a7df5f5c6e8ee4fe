#pragma once
// The saved state from which an interrupted import resumes: a file with a header, which contains a checksum, and a zstd
// frame of byte strings in a fixed order, each preceded by its length. One thread.

#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/base/error.h"

namespace shvr {

class StateWriter {
public:
    void put(std::span<const std::byte> piece);
    void put(const std::string& text) { put(std::as_bytes(std::span(text))); }
    template <class T>
    void put_all(const std::vector<T>& elements)
    {
        put(std::as_bytes(std::span(elements)));
    }

    /// Replaces the file atomically. When this returns, the content is on the disk.
    void write(const std::filesystem::path& file) const;

private:
    std::vector<std::byte> bytes_;
};

class StateReader {
public:
    /// Fails if the file is damaged or has another version.
    explicit StateReader(const std::filesystem::path& file);

    /// Returns the next piece; fails if there is none.
    std::span<const std::byte> take();
    std::string take_text();
    /// Reads into existing elements. Fails if the file has a different number of elements.
    template <class T>
    void take_all(std::vector<T>& elements)
    {
        const std::span<const std::byte> piece = take();
        if (piece.size() != elements.size() * sizeof(T)) refuse();
        if (!piece.empty()) std::memcpy(elements.data(), piece.data(), piece.size());
    }
    /// Reads elements whose number the file states.
    template <class T>
    std::vector<T> take_list()
    {
        const std::span<const std::byte> piece = take();
        if (piece.size() % sizeof(T) != 0) refuse();
        std::vector<T> elements(piece.size() / sizeof(T));
        if (!piece.empty()) std::memcpy(elements.data(), piece.data(), piece.size());
        return elements;
    }
    [[noreturn]] void refuse() const;

private:
    std::filesystem::path file_;
    std::vector<std::byte> bytes_;
    size_t at_ = 0;
};

}  // namespace shvr
