# Scattermark in two stages: the first builds the wheel and installs it into an environment of its own, the second
# holds nothing but Python and that environment.
#
#   docker build -t scattermark .
#   docker run --rm -p 127.0.0.1:8000:8000 -v scattermark:/data \
#     -e SCATTERMARK_BOOTSTRAP_KEY="$(openssl rand -hex 32)" scattermark
#
# docker-compose.yml runs it with Postgres, builds apart, behind a proxy that speaks TLS.

FROM python:3.13-slim AS build

WORKDIR /src
COPY pyproject.toml README.md LICENSE ./
COPY app app
COPY migrations migrations
RUN python -m pip wheel --no-cache-dir --no-deps --wheel-dir /wheels .
RUN python -m venv /opt/scattermark \
    && /opt/scattermark/bin/python -m pip install --no-cache-dir "$(echo /wheels/scattermark-*.whl)[postgres]"


FROM python:3.13-slim

LABEL org.opencontainers.image.title="Scattermark" \
      org.opencontainers.image.description="Indoor positioning ground truth from photographs of printed targets" \
      org.opencontainers.image.licenses="Apache-2.0"

# The environment's scripts name their interpreter by its path, so it stays where it was made.
COPY --from=build /opt/scattermark /opt/scattermark

# The service needs a number, not an account: it owns /data and nothing else.
RUN install -d -o 10001 -g 10001 -m 0750 /data

ENV PATH=/opt/scattermark/bin:$PATH \
    HOME=/data \
    PYTHONUNBUFFERED=1 \
    PYTHONDONTWRITEBYTECODE=1 \
    SCATTERMARK_DATA_DIR=/data

USER 10001:10001
WORKDIR /data
VOLUME /data
EXPOSE 8000

HEALTHCHECK --interval=10s --timeout=5s --start-period=60s --retries=3 \
    CMD ["python", "-c", "from urllib.request import urlopen; urlopen('http://127.0.0.1:8000/healthz', timeout=4)"]

# What is under way is finished; the service takes ten seconds at most.
STOPSIGNAL SIGTERM

ENTRYPOINT ["scattermark"]
# Whoever can reach it needs a key: it starts once there is one, or SCATTERMARK_BOOTSTRAP_KEY to make it of.
CMD ["serve", "--host", "0.0.0.0", "--port", "8000"]
