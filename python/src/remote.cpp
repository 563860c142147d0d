// octopair._remote: engines, detached jobs and scenes of a server. A module of its own, because it links gRPC.
#include <chrono>
#include <optional>
#include <string>

#include "arrays.hpp"
#include "bindings.hpp"
#include "call.hpp"
#include "engines.hpp"
#include "octopair/client.hpp"
#include "octopair/job_client.hpp"
#include "octopair/remote_scene.hpp"
#include "scenes.hpp"

namespace octopair::python {

namespace {

std::chrono::milliseconds milliseconds_of(const py::handle& seconds) {
    return std::chrono::milliseconds(std::int64_t(seconds.cast<double>() * 1e3));
}

/// `settings` is a dict of members of ClientOptions; times are in seconds.
ClientOptions options_of(const py::dict& settings) {
    ClientOptions options;
    const auto set = [&](const char* name, auto& member) {
        if (settings.contains(name)) member = settings[name].cast<std::decay_t<decltype(member)>>();
    };
    set("token", options.token);
    set("server_user", options.server_user);
    set("token_in_clear", options.token_in_clear);
    set("owner", options.owner);
    set("authority", options.authority);
    set("certificate", options.certificate);
    set("key", options.key);
    set("tls", options.tls);
    if (settings.contains("connect_timeout")) options.connect_timeout = milliseconds_of(settings["connect_timeout"]);
    if (settings.contains("patience")) options.patience = milliseconds_of(settings["patience"]);
    return options;
}

/// Runs a call of a server: like a long call, because the server may be slow.
template <typename Work>
void call_server(const py::object& progress, Work work) {
    call({.progress = progress, .repeatable = false}, work);
}

std::shared_ptr<PythonEngine> connect_engine(const std::string& address, const py::dict& settings) {
    const ClientOptions options = options_of(settings);
    std::shared_ptr<PythonEngine> engine;
    call_server(py::none(),
                [&](auto&&...) { engine = std::make_shared<PythonEngine>(connect(address, options), true); });
    return engine;
}

/// Returns a status as a dict for octopair/remote.py.
py::dict status_dict(const JobStatus& status) {
    py::dict row;
    row["id"] = status.id;
    row["state"] = state_name(status.state);
    row["detached"] = status.detached;
    row["count_only"] = status.count_only;
    row["progress"] = status.progress;
    row["queued_before"] = status.queued_before;
    row["objects"] = status.objects;
    row["summary"] = summary_tuple(status.summary);
    row["error"] =
        status.error ? py::object(py::make_tuple(int(status.error->code()), status.error->what())) : py::none();
    row["owner"] = status.owner;
    row["waits_for_room"] = status.waits_for_room;
    return row;
}

class PythonJobClient {
public:
    PythonJobClient(const std::string& address, const py::dict& settings) {
        check_not_forked();
        client_.reset(new JobClient(address, options_of(settings)));
    }

    /// `terms` is (id, count_only, progress).
    std::string submit(const ArrayInput& input, const Options& options, const py::tuple& terms) {
        const JobTerms wanted{terms[0].cast<std::string>(), terms[1].cast<bool>()};
        const py::object progress = terms[2];
        std::string id;
        call_server(progress, [&](const std::stop_token& stop, ProgressValue& value) {
            id = client_->submit(input.input(), with_progress(options, progress, value), wanted, stop);
        });
        return id;
    }
    py::dict status(const std::string& id) {
        return status_from([&](const std::stop_token& stop) { return client_->status(id, stop); });
    }
    py::dict wait(const std::string& id, double seconds) {
        return status_from([&](const std::stop_token& stop) {
            return client_->wait(id, std::chrono::duration<double>(seconds), stop);
        });
    }
    py::dict cancel(const std::string& id) {
        return status_from([&](const std::stop_token& stop) { return client_->cancel(id, stop); });
    }
    void release(const std::string& id) {
        call_server(py::none(), [&](const std::stop_token& stop, auto&) { client_->release(id, stop); });
    }
    void drain() {
        call_server(py::none(), [&](const std::stop_token& stop, auto&) { client_->drain(stop); });
    }
    py::list list() {
        std::vector<JobStatus> found;
        call_server(py::none(), [&](const std::stop_token& stop, auto&) { found = client_->list(stop); });
        py::list rows;
        for (const JobStatus& status : found) rows.append(status_dict(status));
        return rows;
    }
    /// Returns (pairs, summary).
    py::tuple result(const std::string& id, const py::object& progress) {
        PairList pairs;
        Summary summary;
        call_server(progress, [&](const std::stop_token& stop, ProgressValue& value) {
            summary = client_->result(
                id, pairs, [&](double fraction) { value.set(fraction); }, stop);
        });
        return py::make_tuple(pairs_array(pairs), summary_tuple(summary));
    }

private:
    template <typename Get>
    py::dict status_from(Get get) {
        JobStatus status;
        call_server(py::none(), [&](const std::stop_token& stop, auto&) { status = get(stop); });
        return status_dict(status);
    }

    std::unique_ptr<JobClient, ReleasedDelete> client_;
};

using PythonRemoteScene = PythonScene<RemoteScene>;

std::unique_ptr<PythonRemoteScene> make_remote_scene(const std::string& address, const py::tuple& scene,
                                                     const py::dict& client) {
    const RemoteSceneOptions options{scene[0].cast<bool>() ? Precision::float64 : Precision::float32,
                                     scene[1].cast<double>()};
    const ClientOptions connection = options_of(client);
    std::unique_ptr<PythonRemoteScene> made;
    call_server(py::none(), [&](auto&&...) {
        made = std::make_unique<PythonRemoteScene>(connect_scene(address, options, connection));
    });
    return made;
}

}  // namespace

}  // namespace octopair::python

PYBIND11_MODULE(_remote, module) {
    using namespace octopair::python;
    // This module has Engine, Options and Input. It must also notice a fork.
    py::module_::import("octopair._core").attr("mark_used")();
    register_errors();
    watch_end_of_interpreter();
    module.def("connect", &connect_engine, py::arg("address"), py::arg("settings"));
    py::class_<PythonJobClient>(module, "JobClient")
        .def(py::init<const std::string&, const py::dict&>(), py::arg("address"), py::arg("settings"))
        .def("submit", &PythonJobClient::submit, py::arg("input"), py::arg("options"), py::arg("terms"))
        .def("status", &PythonJobClient::status, py::arg("id"))
        .def("wait", &PythonJobClient::wait, py::arg("id"), py::arg("seconds"))
        .def("cancel", &PythonJobClient::cancel, py::arg("id"))
        .def("release", &PythonJobClient::release, py::arg("id"))
        .def("drain", &PythonJobClient::drain)
        .def("list", &PythonJobClient::list)
        .def("result", &PythonJobClient::result, py::arg("id"), py::arg("progress"));
    py::class_<PythonRemoteScene> scene(module, "Scene");
    scene.def(py::init(&make_remote_scene), py::arg("address"), py::arg("options"), py::arg("client"));
    bind_scene_calls(scene);
}
