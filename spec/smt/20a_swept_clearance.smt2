; THEOREM    20a: what the check of a way past somebody means.
; ASSUMED    (s, k) is a unit vector, the way leads from the origin along it for the length L, and
;            somebody at (x, z) passes the check of valley.INV-1: from the nearer end if they are
;            level with neither, else from the line.
; CONCLUDED  Every point of the way is c at least from (x, z).
; SOURCE     own; spec/valley.md, valley.INV-1.
; TWIN       who is beyond the far end is not looked at.
; SOLVERS    z3
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const x Real)        ; where somebody is, across
(declare-const z Real)        ; and ahead
(declare-const s Real)        ; sine of the way's direction
(declare-const k Real)        ; cosine of the way's direction
(declare-const L Real)        ; its length
(declare-const c Real)        ; clearance to be kept
(declare-const t Real)        ; how far along a point of the way is
(define-fun along () Real (+ (* x s) (* z k)))
(define-fun aside () Real (- (* x k) (* z s)))
; Assumptions
(assert (= (+ (* s s) (* k k)) 1))
(assert (>= c 0))
(assert (<= 0 t L))
(assert (=> (<= along 0) (>= (+ (* x x) (* z z)) (* c c))))
(assert (=> (and (< 0 along) (< along L)) (>= (* aside aside) (* c c))))
(assert (=> (>= along L) (>= (+ (* (- x (* s L)) (- x (* s L))) (* (- z (* k L)) (- z (* k L)))) (* c c))))

; Conclusion, negated
(assert (not (>= (+ (* (- x (* s t)) (- x (* s t))) (* (- z (* k t)) (- z (* k t)))) (* c c))))
(check-sat)
