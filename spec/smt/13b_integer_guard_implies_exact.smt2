; THEOREM    13b: the guard in integers implies the exact one.
; ASSUMED    Every term is what 13a makes of it or more, every datum is rounded to the safe side,
;            and the guard in thousandths of a millimetre holds. (Reals stand for the integers:
;            nothing but the rounding is used.)
; CONCLUDED  The exact guard holds, with eps = E/1000.
; SOURCE     own; src/shield.rs, Limits::needed.
; TWIN       the braking way is rounded down.
; SOLVERS    z3
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; braking, mm/s^2
(declare-const E Real)        ; reaction time, ms
(declare-const V Real)        ; speed of the class, mm/s
(declare-const kappa Real)    ; closing cosine, exact
(declare-const K Real)        ; closing cosine in thousandths, rounded up
(declare-const s Real)        ; own way since seen, exact, mm
(declare-const S Real)        ; the same, rounded up
(declare-const age Real)      ; age, exact, s
(declare-const G Real)        ; the same in ms, rounded up
(declare-const d Real)        ; clearance, exact, mm
(declare-const D Real)        ; the same, rounded down
(declare-const w Real)        ; greatest speed until braking, mm/s
(declare-const way1 Real)     ; w E/1000, rounded up, mm
(declare-const way2 Real)     ; w^2/2b, rounded up, mm
(declare-const time2 Real)    ; 1000 w/b, rounded up, ms
; Formulas
(define-fun eps () Real (/ E 1000))
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun need ((w Real)) Real
  (+ (* kappa (+ s (way_to_rest w))) (* V (+ age (time_to_rest w)))))

; Assumptions
(assert (and (> b 0) (> E 0)))
(assert (and (>= V 0) (>= s 0) (>= age 0) (>= w 0) (>= way1 0) (>= way2 0)))
(assert (<= 0 kappa 1))
(assert (>= K (* 1000 kappa)))
(assert (>= S s))
(assert (>= G (* 1000 age)))
(assert (<= D d))
(assert (>= (* 1000 way1) (* w E)))               ; 13a
(assert (>= (* 2 b way2) (* w w)))                 ; 13a
(assert (>= (* b time2) (* 1000 w)))              ; 13a
(assert (<= (+ (* K (+ S way1 way2)) (* V (+ G E time2))) (* 1000 D)))

; Conclusion, negated
(assert (not (<= (need w) d)))
(check-sat)
