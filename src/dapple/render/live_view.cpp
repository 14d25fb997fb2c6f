// The protocol, from tev's source (include/tev/Ipc.h, src/Ipc.cpp): numbers are little endian, texts end in a zero
// byte.
//   CreateImage    u32 length, u8 4, u8 grab focus, name, i32 width, height, channel count, names
//   UpdateImageV3  u32 length, u8 6, u8 grab focus, name, i32 channel count, names, i32 x, y, width, height,
//                  i64 offset of each channel, i64 stride of each, f32 values; offsets and strides count values
#include "dapple/render/live_view.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>

namespace dapple {
namespace {

constexpr double seconds_between_images = 1.0;
constexpr double seconds_between_tries = 10.0;
constexpr double patience = 3.0;  // [s] without a byte taken before a viewer counts as gone
constexpr std::chrono::seconds wait_at_end{2};
constexpr int poll_ms = 50;
constexpr size_t band_bytes = size_t{1} << 18;

const std::vector<std::string> beauty_channels = {"R", "G", "B"};

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

template <class T>
void append(tev::Message& message, T value)
{
    message.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_text(tev::Message& message, const std::string& text) { message.append(text.c_str(), text.size() + 1); }

tev::Message begin(uint8_t kind, bool grab_focus, const std::string& name)
{
    tev::Message message(sizeof(uint32_t), '\0');
    append(message, kind);
    append(message, static_cast<uint8_t>(grab_focus));
    append_text(message, name);
    return message;
}

tev::Message finished(tev::Message message)
{
    const auto length = static_cast<uint32_t>(message.size());
    std::memcpy(message.data(), &length, sizeof length);
    return message;
}

// Waits until the socket can be written to. False when it took too long, or the render ended.
bool wait_writable(int socket, const std::stop_token& token)
{
    const double start = now();
    while (!token.stop_requested() && now() - start < patience) {
        pollfd wanted = {socket, POLLOUT, 0};
        if (::poll(&wanted, 1, poll_ms) > 0) return true;
    }
    return false;
}

}  // namespace

namespace tev {

Message create_image(const std::string& name, int width, int height, const std::vector<std::string>& channels)
{
    Message message = begin(4, true, name);
    append(message, int32_t(width));
    append(message, int32_t(height));
    append(message, static_cast<int32_t>(channels.size()));
    for (const std::string& channel : channels) append_text(message, channel);
    return finished(std::move(message));
}

Message update_rows(const std::string& name, const std::vector<std::string>& channels, const Image& image,
                    int first_row, int rows)
{
    Message message = begin(6, false, name);
    append(message, static_cast<int32_t>(channels.size()));
    for (const std::string& channel : channels) append_text(message, channel);
    for (const int number : {0, first_row, image.width, rows}) append(message, int32_t(number));
    for (size_t c = 0; c < channels.size(); ++c) append(message, static_cast<int64_t>(c));
    for (size_t c = 0; c < channels.size(); ++c) append(message, int64_t(image.channels));
    const size_t row = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels);
    const auto* first = reinterpret_cast<const char*>(image.pixels.data() + row * static_cast<size_t>(first_row));
    message.append(first, row * static_cast<size_t>(rows) * sizeof(float));
    return finished(std::move(message));
}

}  // namespace tev

LiveView::LiveView(const std::string& server, std::string image_name) : server_(server), name_(std::move(image_name))
{
    const size_t colon = server.rfind(':');
    std::string host = server.substr(0, colon);
    std::string port = colon == std::string::npos ? "14158" : server.substr(colon + 1);
    if (host.empty()) host = "127.0.0.1";
    const bool number = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
    if (!number || std::stoi(port) < 1 || std::stoi(port) > 65535)
        throw UserError("--display-server takes HOST:PORT such as 127.0.0.1:14158, not '" + server + "'");
    addrinfo hints = {};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (const int error = getaddrinfo(host.c_str(), port.c_str(), &hints, &found); error != 0)
        throw UserError(fmt::format("--display-server: host '{}' is not known ({})", host, gai_strerror(error)));
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, &freeaddrinfo);
    for (const addrinfo* at = found; at; at = at->ai_next) {
        const auto* bytes = reinterpret_cast<const char*>(at->ai_addr);
        addresses_.push_back({at->ai_family, std::vector<char>(bytes, bytes + at->ai_addrlen)});
    }
    thread_ = std::jthread([this](const std::stop_token& token) { run(token); });
}

LiveView::~LiveView()
{
    thread_.request_stop();
    thread_.join();
    if (socket_ >= 0) ::close(socket_);
}

void LiveView::after_pass(const Film& film, const RenderCounters&)
{
    {
        const std::lock_guard lock(mutex_);
        if (busy_ || waiting_ || now() - last_handed_ < seconds_between_images) return;
    }
    hand_over(film.beauty());
}

void LiveView::hand_over(Image image)
{
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(image);
    last_handed_ = now();
    changed_.notify_all();
}

void LiveView::finish(const Film& film)
{
    hand_over(film.beauty());
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait_at_end, [this] { return !waiting_ && !busy_; });
}

void LiveView::run(const std::stop_token& token)
{
    while (true) {
        Image image;
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, token, [this] { return waiting_.has_value(); })) return;
            image = std::move(*waiting_);
            waiting_.reset();
            busy_ = true;
        }
        send_image(image, token);
        const std::lock_guard lock(mutex_);
        busy_ = false;
        changed_.notify_all();
    }
}

bool LiveView::send_image(const Image& image, const std::stop_token& token)
{
    if (socket_ < 0 && !connect(token)) return false;
    if (!created_ && !send(tev::create_image(name_, image.width, image.height, beauty_channels), token)) return false;
    created_ = true;
    const size_t row_bytes = static_cast<size_t>(image.width) * 3 * sizeof(float);
    const int rows = static_cast<int>(std::max<size_t>(1, band_bytes / row_bytes));
    for (int row = 0; row < image.height; row += rows)
        if (!send(tev::update_rows(name_, beauty_channels, image, row, std::min(rows, image.height - row)), token))
            return false;
    return true;
}

bool LiveView::connect(const std::stop_token& token)
{
    if (now() < next_try_) return false;
    int cause = 0;
    for (const Address& address : addresses_) {
        socket_ = ::socket(address.family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
        if (socket_ < 0) continue;
        const auto* name = reinterpret_cast<const sockaddr*>(address.bytes.data());
        cause = ::connect(socket_, name, static_cast<socklen_t>(address.bytes.size())) == 0 ? 0 : errno;
        if (cause == EINPROGRESS) {
            socklen_t length = sizeof cause;
            if (!wait_writable(socket_, token))
                cause = ETIMEDOUT;
            else if (::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &cause, &length) != 0)
                cause = errno;
        }
        if (cause == 0) return true;
        ::close(socket_);
        socket_ = -1;
    }
    disconnect(std::strerror(cause));
    return false;
}

bool LiveView::send(const tev::Message& message, const std::stop_token& token)
{
    for (size_t sent = 0; sent < message.size();) {
        const ssize_t taken = ::send(socket_, message.data() + sent, message.size() - sent, MSG_NOSIGNAL);
        if (taken > 0) {
            sent += static_cast<size_t>(taken);
        } else if (taken < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
            if (wait_writable(socket_, token)) continue;
            disconnect("it takes no more data");
            return false;
        } else {
            disconnect(std::strerror(errno));
            return false;
        }
    }
    return true;
}

void LiveView::disconnect(const std::string& why)
{
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    created_ = false;
    next_try_ = now() + seconds_between_tries;
    if (!warned_) log_warning("the viewer at {} is not there: {}; the render goes on without it", server_, why);
    warned_ = true;
}

}  // namespace dapple
