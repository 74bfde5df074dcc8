# docker build -t slewlab . && docker run --rm -v "$PWD/runs:/runs" slewlab
#
# Default: the demo's two runs and its page, into /runs. Any command of slewlab: docker run --rm slewlab slewlab --help
FROM debian:bookworm-slim AS build
WORKDIR /source
COPY . .
RUN tools/setup \
 && tools/build slewlab slewlab-plant slewlab-controller slewlab_pages slewlab_python_messages slewlab_python_package \
 && cpack --config build/release/CPackConfig.cmake -B /package

FROM debian:bookworm-slim
COPY --from=build /package/slewlab_*.deb /tmp/
COPY --from=build /source/tools/python/requirements.txt /tmp/
RUN apt-get update \
 && apt-get install --yes --no-install-recommends /tmp/slewlab_*.deb iproute2 python3 python3-venv util-linux \
 && python3 -m venv /usr/share/slewlab/.venv \
 && /usr/share/slewlab/.venv/bin/pip install --quiet --only-binary :all: -r /tmp/requirements.txt \
 && rm -rf /var/lib/apt/lists/* /tmp/slewlab_*.deb /tmp/requirements.txt
WORKDIR /runs
CMD ["/bin/sh", "-c", "for s in thesis_slew thesis_slew_without_play_compensation; do slewlab run /usr/share/slewlab/config/scenarios/$s.yaml --out $s || exit 1; done; slewlab report thesis_slew thesis_slew_without_play_compensation --out play_compensation.html"]
