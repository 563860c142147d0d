"""Python classes of the protocol, generated from octopair.proto by protoc and gRPC's plugin."""
import functools
import importlib
import shutil
import subprocess
import sys
import tempfile

import settings

SERVICE = "octopair.v1.Octopair"
MESSAGE_BYTES = 4 << 20  # bytes of a message at most (docs/protocol.md)


@functools.lru_cache(maxsize=None)
def _modules():
    """Generates the classes. Returns the module of the messages and the module of the stubs."""
    proto, plugin = settings.proto(), shutil.which("grpc_python_plugin")
    if plugin is None:
        sys.exit("grpc_python_plugin is not installed")
    with tempfile.TemporaryDirectory(prefix="octopair_stubs_") as folder:
        subprocess.run(["protoc", f"--proto_path={proto.parent}", f"--python_out={folder}", f"--grpc_python_out={folder}",
                        f"--plugin=protoc-gen-grpc_python={plugin}", str(proto)], check=True)
        sys.path.insert(0, folder)
        try:
            return importlib.import_module("octopair_pb2"), importlib.import_module("octopair_pb2_grpc")
        finally:
            sys.path.remove(folder)


def messages():
    """Returns the module with the message classes."""
    return _modules()[0]


def stub(channel):
    """Returns a stub of the service, as a program in Python uses it."""
    return _modules()[1].OctopairStub(channel)


@functools.lru_cache(maxsize=None)
def methods():
    """Returns the methods of the service: name -> Method."""
    service = messages().DESCRIPTOR.services_by_name["Octopair"]
    streams = _streams()
    return {method.name: Method(method, *streams[method.name]) for method in service.methods}


def ordinary_methods():
    """Returns the names of the methods that every client may call: all but Drain, which ends the server."""
    return [name for name in methods() if name != "Drain"]


def _streams():
    """Returns for each method whether the request is a stream, and whether the answer is."""
    from google.protobuf import descriptor_pb2
    file = descriptor_pb2.FileDescriptorProto()
    messages().DESCRIPTOR.CopyToProto(file)
    return {method.name: (method.client_streaming, method.server_streaming) for method in file.service[0].method}


class Method:
    """A method: its path, its classes, and which sides are streams."""

    def __init__(self, descriptor, requests_stream, answers_stream):
        self.name = descriptor.name
        self.path = f"/{SERVICE}/{descriptor.name}"
        self.request = getattr(messages(), descriptor.input_type.name)
        self.answer = getattr(messages(), descriptor.output_type.name)
        self.requests_stream, self.answers_stream = requests_stream, answers_stream
