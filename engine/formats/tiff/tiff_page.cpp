#include "engine/formats/tiff/tiff_page.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <mutex>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

struct TiffPage::Access {
    const TiffFile& file;
    std::array<std::byte, 16> header{};  ///< the file's header, with this page's offset as the first directory
    size_t header_bytes = 0;
    int64_t position = 0;
    std::string complaint{};

    static Access& of(thandle_t handle) { return *static_cast<Access*>(handle); }

    // An exception must not propagate through libtiff, so failed reads return -1, as libtiff expects.
    static tmsize_t read(thandle_t handle, void* bytes, tmsize_t count) noexcept
    {
        Access& access = of(handle);
        try {
            const std::span<std::byte> wanted(static_cast<std::byte*>(bytes), size_t(count));
            const size_t done = access.file.read_some(access.position, wanted);
            for (size_t i = 0; i < done; ++i) {
                const size_t at = size_t(access.position) + i;
                if (at >= access.header_bytes) break;
                wanted[i] = access.header[at];
            }
            access.position += int64_t(done);
            return static_cast<tmsize_t>(done);
        } catch (const std::exception& error) {
            access.complaint = error.what();
            return -1;
        }
    }
    static tmsize_t write(thandle_t /*handle*/, void* /*bytes*/, tmsize_t /*count*/) { return -1; }
    static toff_t seek(thandle_t handle, toff_t offset, int from)
    {
        Access& access = of(handle);
        const auto distance = int64_t(offset);
        if (from == SEEK_SET) access.position = distance;
        if (from == SEEK_CUR) access.position += distance;
        if (from == SEEK_END) access.position = access.file.size_bytes() + distance;
        return static_cast<toff_t>(access.position);
    }
    static int close(thandle_t /*handle*/) { return 0; }
    static toff_t size(thandle_t handle) { return static_cast<toff_t>(of(handle).file.size_bytes()); }

    static int complain(TIFF* /*tiff*/, void* access, const char* /*module*/, const char* format, va_list values)
    {
        char text[256];
        std::vsnprintf(text, sizeof(text), format, values);
        static_cast<Access*>(access)->complaint = text;
        return 1;  // handled: keeps libtiff from calling its global handlers
    }
    static int ignore(TIFF* /*tiff*/, void* /*access*/, const char* /*module*/, const char* /*format*/,
                      va_list /*values*/)
    {
        return 1;
    }
};

TiffPage::TiffPage(const TiffFile& file, uint64_t directory, size_t page, int64_t max_memory_bytes)
    : file_(file), page_(page), access_(new Access{file})
{
    // Disables libtiff's global handlers, since a few of its messages bypass the handlers set for a file.
    static std::once_flag silence;
    std::call_once(silence, [] {
        TIFFSetErrorHandler(nullptr);
        TIFFSetWarningHandler(nullptr);
    });

    const size_t offset_bytes = file.has_wide_offsets() ? 8 : 4;
    access_->header_bytes = 2 * offset_bytes;
    file.read(0, std::span(access_->header).first(access_->header_bytes));
    for (size_t i = 0; i < offset_bytes; ++i) {
        const size_t place = file.is_big_endian() ? offset_bytes - 1 - i : i;
        access_->header[offset_bytes + place] = std::byte(directory >> 8 * i);
    }

    const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                               TIFFOpenOptionsFree);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), max_memory_bytes);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), Access::complain, access_.get());
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), Access::ignore, nullptr);
    // "m": no memory mapping, so truncating the open file causes a failed read instead of a signal. "O": strip offsets
    // are read only when needed.
    handle_ = TIFFClientOpenExt("TIFF", "rmO", access_.get(), Access::read, Access::write, Access::seek, Access::close,
                                Access::size, nullptr, nullptr, options.get());
    if (handle_ == nullptr)
        fail(subject(), " cannot be read: ", complaint(),
             "; expected an intact TIFF: save it again, for example from Fiji");
}

TiffPage::~TiffPage()
{
    if (handle_ != nullptr) TIFFClose(handle_);
}

std::string TiffPage::subject() const
{
    return sentence(file_.path().string(), ": page ", page_);
}

std::string TiffPage::complaint() const
{
    if (access_->complaint.empty()) return "libtiff gives no reason";
    std::string words = access_->complaint;
    std::replace(words.begin(), words.end(), '"', '\'');
    return "libtiff says " + in_quotes(words);
}

uint16_t TiffPage::number16(uint32_t tag, uint16_t fallback) const
{
    uint16_t number = fallback;
    return TIFFGetFieldDefaulted(handle_, tag, &number) == 1 ? number : fallback;
}

uint32_t TiffPage::number32(uint32_t tag, uint32_t fallback) const
{
    uint32_t number = fallback;
    return TIFFGetFieldDefaulted(handle_, tag, &number) == 1 ? number : fallback;
}

bool TiffPage::has(uint32_t tag) const
{
    // Room for whatever value libtiff stores; only the result of the call matters.
    std::array<void*, 4> values{};
    return TIFFGetField(handle_, tag, &values[0], &values[1], &values[2], &values[3]) == 1;
}

std::string TiffPage::text(uint32_t tag) const
{
    const char* text = nullptr;
    return TIFFGetField(handle_, tag, &text) == 1 && text != nullptr ? text : "";
}

}  // namespace shvr
