# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
#
#   docker build -t mneme .
#   docker run --rm -v "$PWD:/work" -w /work mneme plan scenes/shelf/thin.yaml --view plan.html
#
# `--target build` is the image with compilers and source tree.
FROM debian:bookworm-slim AS build
COPY script/setup /mneme/script/setup
RUN /mneme/script/setup && rm -rf /var/lib/apt/lists/*
COPY . /mneme
WORKDIR /mneme
RUN cmake --preset release -DMNEME_BUILD_TESTS=OFF -DMNEME_BENCH=OFF -DMNEME_PYTHON=OFF \
 && cmake --build --preset release --target mneme_cli mneme_shell_files \
 && cmake --install build/release --prefix /opt/mneme --component cli

FROM debian:bookworm-slim
RUN apt-get update \
 && apt-get install --yes --no-install-recommends \
      libfmt9 libhwy1 libsqlite3-0 libtinyxml2-9 libxxhash0 libyaml-cpp0.7 \
 && rm -rf /var/lib/apt/lists/*
COPY --from=build /opt/mneme /usr/local
ENTRYPOINT ["mneme"]
